//! Distances, boxes and packings of solids, compared with slow and simple computations.

use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Part, Shape, Solid, pack, surface_error};
use bubbletouch_sim::random::Seed;
use glam::{DQuat, DVec2, DVec3};
use rand::Rng;

const MM: f64 = 1e-3;

/// Returns one shape of each kind, about 10 to 60 mm large. The balls of the sphere sweep are far enough apart for its inside distance to be exact.
fn one_of_each() -> Vec<Shape> {
    let corner = |&[x, y]: &[f64; 2]| DVec2::new(x, y) * MM;
    vec![
        Shape::Ball { diameter: 30. * MM },
        Shape::Box {
            size: DVec3::new(20., 40., 10.) * MM,
            rounding: 0.,
        },
        Shape::Box {
            size: DVec3::new(20., 40., 10.) * MM,
            rounding: 3. * MM,
        },
        Shape::Cylinder {
            diameter: 30. * MM,
            height: 20. * MM,
        },
        Shape::Capsule {
            diameter: 10. * MM,
            length: 40. * MM,
        },
        Shape::ConeFrustum {
            bottom_diameter: 30. * MM,
            top_diameter: 10. * MM,
            height: 25. * MM,
        },
        Shape::ConeFrustum {
            bottom_diameter: 0.,
            top_diameter: 20. * MM,
            height: 25. * MM,
        },
        Shape::Torus {
            ring_diameter: 30. * MM,
            tube_diameter: 8. * MM,
        },
        Shape::Tube {
            outer_diameter: 40. * MM,
            inner_diameter: 30. * MM,
            height: 12. * MM,
        },
        Shape::Lathe {
            profile: [
                [0., 0.],
                [10., 0.],
                [20., 15.],
                [17., 15.],
                [9., 3.],
                [0., 3.],
            ]
            .iter()
            .map(corner)
            .collect(),
        },
        Shape::Prism {
            outline: [
                [0., 0.],
                [30., 0.],
                [30., 5.],
                [8., 5.],
                [8., 20.],
                [0., 20.],
            ]
            .iter()
            .map(corner)
            .collect(),
            thickness: 6. * MM,
        },
        Shape::HexagonalPrism {
            across_flats: 13. * MM,
            height: 6.5 * MM,
        },
        Shape::SphereSweep {
            points: vec![DVec3::ZERO, DVec3::new(30., 0., 0.) * MM],
            diameters: vec![12. * MM, 6. * MM],
        },
    ]
}

fn random_pose(rng: &mut impl Rng) -> Pose {
    let mut angle = || rng.gen_range(-3.0..3.0);
    let axis = DVec3::new(angle(), angle(), angle());
    Pose::new(
        DQuat::from_scaled_axis(axis),
        10. * MM * DVec3::new(angle(), angle(), angle()),
    )
}

#[test]
fn the_distance_is_the_distance_to_the_nearest_surface_point() {
    let spacing = 0.25 * MM;
    for (index, shape) in one_of_each().into_iter().enumerate() {
        let mut rng = Seed::new(3).named("distance").numbered(index as u64).rng();
        let pose = random_pose(&mut rng);
        let solid = Solid::new(vec![Part::new(shape.clone(), pose).unwrap()]).unwrap();
        let surface = solid.surface_points(spacing);
        let bounds = solid.bounds();
        let (mut n_inside, mut n_outside) = (0, 0);
        while n_inside < 20 || n_outside < 60 {
            let at = DVec3::new(rng.r#gen(), rng.r#gen(), rng.r#gen());
            let point = bounds.center() + 1.5 * bounds.size() * (at - 0.5);
            let nearest = surface
                .iter()
                .map(|p| (*p - point).length())
                .fold(f64::INFINITY, f64::min);
            let distance = solid.distance(point);
            // The nearest sample is less than one spacing away from the true foot.
            assert!(
                nearest >= distance.abs() - 1e-12 && nearest <= distance.abs() + spacing,
                "{shape:?}: distance {distance}, nearest sample {nearest}"
            );
            *(if distance < 0.0 {
                &mut n_inside
            } else {
                &mut n_outside
            }) += 1;
        }
    }
}

#[test]
fn points_of_the_surface_have_no_distance_and_fill_the_box() {
    for shape in one_of_each() {
        let mut rng = Seed::new(3).named("surface").rng();
        let pose = random_pose(&mut rng);
        let solid = Solid::new(vec![Part::new(shape.clone(), pose).unwrap()]).unwrap();
        let points = solid.surface_points(0.25 * MM);
        assert!(
            points.iter().all(|&p| solid.distance(p).abs() < 1e-9),
            "{shape:?}"
        );
        let low = points.iter().copied().fold(DVec3::MAX, DVec3::min);
        let high = points.iter().copied().fold(DVec3::MIN, DVec3::max);
        let bounds = solid.bounds();
        let apart = (low - bounds.min).max(bounds.max - high);
        assert!(
            apart.min_element() > -1e-12 && apart.max_element() < 0.1 * MM,
            "{shape:?}: {apart}"
        );
    }
}

#[test]
fn a_union_of_posed_parts_packs_within_the_tolerance() {
    for case in 0..40 {
        let mut rng = Seed::new(4).named("union").numbered(case).rng();
        let shapes = one_of_each();
        let parts = (0..rng.gen_range(2..5)).map(|_| {
            let shape = shapes[rng.gen_range(0..shapes.len())].clone();
            Part::new(shape, random_pose(&mut rng)).unwrap()
        });
        let solid = Solid::new(parts.collect()).unwrap();
        let tolerance = 0.3 * MM;
        let union = pack(&solid, tolerance).unwrap();
        let error = surface_error(&solid, &union, 1. * MM);
        assert!(
            error.protrusion <= 0.5 * tolerance && error.gap <= tolerance,
            "case {case}: {error:?}"
        );
    }
}

/// Creates an M8 nut whose hole ends exactly at the nut's faces or extends beyond them.
fn nut(hole: f64) -> Solid {
    let prism = Shape::HexagonalPrism {
        across_flats: 13. * MM,
        height: 6.5 * MM,
    };
    let hole = Shape::Cylinder {
        diameter: 8. * MM,
        height: hole,
    };
    let hole = Part::new(hole, Pose::IDENTITY).unwrap();
    Solid::from_shape(prism).unwrap().less(vec![hole]).unwrap()
}

#[test]
fn a_nut_has_a_hole_that_no_sphere_closes() {
    for hole in [6.5 * MM, 10. * MM] {
        let solid = nut(hole);
        // No membrane closes the hole.
        assert!(solid.distance(DVec3::new(1., 0., 3.25) * MM) > 0.0);
        for tolerance in [0.5 * MM, 0.1 * MM] {
            let union = pack(&solid, tolerance).unwrap();
            let error = surface_error(&solid, &union, 0.1 * MM);
            assert!(
                error.protrusion <= 0.5 * tolerance && error.gap <= tolerance,
                "{error:?} at {tolerance}"
            );
            // Only points in the hole, up to the spheres' share of the tolerance from its wall.
            let free = (4. * MM) - 0.5 * tolerance;
            for k in 0..200 {
                let height = MM * (0.04 * f64::from(k) - 4.0);
                let at = DVec2::from_angle(f64::from(k)) * free * f64::from(k % 11) / 10.0;
                let point = at.extend(height);
                let outside = union
                    .spheres()
                    .iter()
                    .all(|s| s.center.distance(point) >= s.radius - 1e-12);
                assert!(outside, "{point} is in a sphere");
            }
            let wall = DVec3::new(5.25 * MM, 0.0, 0.0);
            assert!(
                union
                    .spheres()
                    .iter()
                    .any(|s| s.center.distance(wall) < s.radius)
            );
        }
    }
}

#[test]
fn whatever_is_subtracted_the_rest_packs_within_the_tolerance() {
    let shapes = one_of_each();
    let mut n_packed = 0;
    for case in 0..24 {
        let mut rng = Seed::new(5).named("difference").numbered(case).rng();
        let mut parts = |n| -> Vec<Part> {
            let part = |_| {
                let shape = shapes[rng.gen_range(0..shapes.len())].clone();
                Part::new(shape, random_pose(&mut rng)).unwrap()
            };
            (0..n).map(part).collect()
        };
        let whole = Solid::new(parts(2)).unwrap();
        let Ok(solid) = whole.less(parts(2)) else {
            continue;
        };
        let tolerance = 0.4 * MM;
        let union = pack(&solid, tolerance).unwrap();
        let error = surface_error(&solid, &union, 0.7 * MM);
        assert!(
            error.protrusion <= 0.5 * tolerance && error.gap <= tolerance,
            "case {case}: {error:?}"
        );
        n_packed += 1;
    }
    assert!(n_packed > 20, "{n_packed}");
}

#[test]
fn a_shape_that_is_subtracted_from_itself_leaves_nothing_to_touch() {
    let ball = Shape::Ball { diameter: 10. * MM };
    let part = Part::new(ball.clone(), Pose::IDENTITY).unwrap();
    let error = Solid::from_shape(ball)
        .unwrap()
        .less(vec![part])
        .unwrap_err();
    assert!(error.to_string().starts_with("subtract: "), "{error}");
}

#[test]
fn the_measured_surface_error_sees_a_sphere_that_is_missing_or_too_large() {
    let solid = Solid::from_shape(Shape::Cylinder {
        diameter: 30. * MM,
        height: 20. * MM,
    })
    .unwrap();
    let union = pack(&solid, 0.2 * MM).unwrap();
    let mut fewer = union.spheres().to_vec();
    fewer.remove(0);
    let fewer = bubbletouch_sim::objects::SphereUnion::new(fewer).unwrap();
    assert!(surface_error(&solid, &fewer, 0.2 * MM).gap > 0.2 * MM);
    let mut larger = union.spheres().to_vec();
    larger[0].radius += 0.3 * MM;
    let larger = bubbletouch_sim::objects::SphereUnion::new(larger).unwrap();
    assert!(surface_error(&solid, &larger, 0.2 * MM).protrusion > 0.29 * MM);
}

#[test]
fn simple_shapes_take_few_spheres() {
    let count = |shape: Shape, tolerance: f64| {
        pack(&Solid::from_shape(shape).unwrap(), tolerance)
            .unwrap()
            .n_spheres()
    };
    assert_eq!(count(Shape::Ball { diameter: 65. * MM }, 0.1 * MM), 1);
    // Each ball of the row covers 2 · sqrt(0.375 · 10.375) = 3.9 mm of the 90 mm between the ends, which cover 1.6 mm each.
    assert_eq!(
        count(
            Shape::Capsule {
                diameter: 10. * MM,
                length: 100. * MM
            },
            0.25 * MM
        ),
        25
    );
    let torus = Shape::Torus {
        ring_diameter: 60. * MM,
        tube_diameter: 10. * MM,
    };
    assert_eq!(count(torus, 0.25 * MM), 52);
    // The rims have balls of about 1.2 mm, one ball per slice of the barrel.
    assert!(
        count(
            Shape::Cylinder {
                diameter: 19. * MM,
                height: 121. * MM
            },
            0.25 * MM
        ) <= 290
    );
    // Expected spheres: 12 edges at 5.66 e, then about 4 A / 8er spheres on 2 · 158 · 210 mm² and the four sides.
    let size = DVec3::new(158., 60., 210.) * MM;
    assert!(count(Shape::Box { size, rounding: 0. }, 0.5 * MM) <= 3_700);
}

#[test]
fn packing_twice_gives_the_same_bits() {
    for shape in one_of_each() {
        let solid = Solid::from_shape(shape).unwrap();
        assert_eq!(
            pack(&solid, 0.2 * MM).unwrap(),
            pack(&solid, 0.2 * MM).unwrap()
        );
    }
}

#[test]
fn spheres_deep_inside_another_part_are_left_out() {
    let rod = Shape::Cylinder {
        diameter: 4. * MM,
        height: 100. * MM,
    };
    let ball = Shape::Ball { diameter: 60. * MM };
    let part = |shape: &Shape| Part::new(shape.clone(), Pose::IDENTITY).unwrap();
    let alone = pack(&Solid::from_shape(rod.clone()).unwrap(), 0.2 * MM)
        .unwrap()
        .n_spheres();
    let both = Solid::new(vec![part(&ball), part(&rod)]).unwrap();
    let packed = pack(&both, 0.2 * MM).unwrap();
    let inside = packed.spheres()[1..]
        .iter()
        .filter(|s| s.center.length() < 25. * MM)
        .count();
    assert_eq!(inside, 0);
    assert!(packed.n_spheres() < alone);
}

#[test]
fn dimensions_out_of_range_are_refused_by_name() {
    let cases = [
        (Shape::Ball { diameter: f64::NAN }, "diameter: NaN m"),
        (
            Shape::Box {
                size: DVec3::new(1., -2., 3.),
                rounding: 0.,
            },
            "size: -2 m",
        ),
        (
            Shape::Box {
                size: DVec3::ONE,
                rounding: 0.6,
            },
            "rounding: 0.6 m; 0 m to 0.5 m",
        ),
        (
            Shape::Capsule {
                diameter: 2.,
                length: 1.,
            },
            "length: 1 m; 2 m or more",
        ),
        (
            Shape::ConeFrustum {
                bottom_diameter: 0.,
                top_diameter: 0.,
                height: 1.,
            },
            "top_diameter: 0 m; a finite positive length",
        ),
        (
            Shape::Torus {
                ring_diameter: 1.,
                tube_diameter: 2.,
            },
            "ring_diameter: 1 m; 2 m or more",
        ),
        (
            Shape::Tube {
                outer_diameter: 1.,
                inner_diameter: 1.,
                height: 1.,
            },
            "inner_diameter: 1 m; less than the outer diameter of 1 m",
        ),
        (
            Shape::Lathe {
                profile: vec![DVec2::ZERO, DVec2::X],
            },
            "profile: 2 corners",
        ),
        (
            Shape::Lathe {
                profile: vec![DVec2::ZERO, DVec2::NEG_X, DVec2::Y],
            },
            "profile: corner 2 left of the axis",
        ),
        (
            Shape::Prism {
                outline: vec![DVec2::ZERO, DVec2::X, DVec2::NAN],
                thickness: 1.,
            },
            "outline: corner 3, which is not finite",
        ),
        (
            Shape::SphereSweep {
                points: vec![DVec3::ZERO],
                diameters: vec![],
            },
            "diameters: 1 points and 0 diameters",
        ),
        (
            Shape::SphereSweep {
                points: vec![DVec3::ZERO; 2],
                diameters: vec![1.; 2],
            },
            "points: point 2 as the one before",
        ),
    ];
    for (shape, expected) in cases {
        let error = Solid::from_shape(shape).unwrap_err().to_string();
        assert!(
            error.starts_with(expected),
            "expected `{expected}` in: {error}"
        );
    }
}
