//! Distances, boxes and packings of solids, compared with slow and simple computations; tolerances of packings, measured on every kind of solid.

use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Part, Solid, SphereUnion, pack, surface_error};
use bubbletouch_sim::random::Seed;
use glam::{DQuat, DVec2, DVec3};
use rand::Rng;

use crate::shapes::{one_of_each, part, shape, solid};

const MM: f64 = 1e-3;

/// Packs a solid; the measured distances between the surfaces must be within the tolerance.
fn assert_packs(solid: &Solid, tolerance: f64, spacing: f64, what: &str) -> SphereUnion {
    let union = pack(solid, tolerance).unwrap();
    let error = surface_error(solid, &union, spacing);
    assert!(
        error.protrusion <= 0.5 * tolerance && error.gap <= tolerance,
        "{what} at {tolerance}: {error:?}, {} spheres",
        union.n_spheres()
    );
    union
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
            n_inside += usize::from(distance < 0.0);
            n_outside += usize::from(distance >= 0.0);
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
        assert_packs(&solid, 0.3 * MM, MM, &format!("case {case}"));
    }
}

/// Creates an M8 nut whose hole ends exactly at the nut's faces or extends beyond them.
fn nut(hole: f64) -> Solid {
    let hole = part(&format!("cylinder diameter=0.008 height={hole}"), [0.0; 3]);
    let nut = solid("hexagonal_prism across_flats=0.013 height=0.0065");
    nut.less(vec![hole]).unwrap()
}

#[test]
fn a_nut_has_a_hole_that_no_sphere_closes() {
    for hole in [6.5 * MM, 10. * MM] {
        let solid = nut(hole);
        // No membrane closes the hole.
        assert!(solid.distance(DVec3::new(1., 0., 3.25) * MM) > 0.0);
        for tolerance in [0.5 * MM, 0.1 * MM] {
            let union = assert_packs(&solid, tolerance, 0.1 * MM, "nut");
            let spheres = || union.spheres().iter();
            // Only points in the hole, up to the spheres' share of the tolerance from its wall.
            let free = (4. * MM) - 0.5 * tolerance;
            for k in 0..200 {
                let height = MM * (0.04 * f64::from(k) - 4.0);
                let at = DVec2::from_angle(f64::from(k)) * free * f64::from(k % 11) / 10.0;
                let point = at.extend(height);
                let outside = spheres().all(|s| s.center.distance(point) >= s.radius - 1e-12);
                assert!(outside, "{point} is in a sphere");
            }
            let wall = DVec3::new(5.25 * MM, 0.0, 0.0);
            assert!(spheres().any(|s| s.center.distance(wall) < s.radius));
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
        assert_packs(&solid, 0.4 * MM, 0.7 * MM, &format!("case {case}"));
        n_packed += 1;
    }
    assert!(n_packed > 20, "{n_packed}");
}

#[test]
fn a_shape_that_is_subtracted_from_itself_leaves_nothing_to_touch() {
    let ball = "ball diameter=0.01";
    let error = solid(ball).less(vec![part(ball, [0.0; 3])]).unwrap_err();
    assert!(error.to_string().starts_with("subtract: "), "{error}");
}

#[test]
fn the_measured_surface_error_sees_a_sphere_that_is_missing_or_too_large() {
    let solid = solid("cylinder diameter=0.03 height=0.02");
    let union = pack(&solid, 0.2 * MM).unwrap();
    let mut fewer = union.spheres().to_vec();
    fewer.remove(0);
    let fewer = SphereUnion::new(fewer).unwrap();
    assert!(surface_error(&solid, &fewer, 0.2 * MM).gap > 0.2 * MM);
    let mut larger = union.spheres().to_vec();
    larger[0].radius += 0.3 * MM;
    let larger = SphereUnion::new(larger).unwrap();
    assert!(surface_error(&solid, &larger, 0.2 * MM).protrusion > 0.29 * MM);
}

#[test]
fn simple_shapes_take_few_spheres() {
    let count = |text: &str, tolerance: f64| pack(&solid(text), tolerance).unwrap().n_spheres();
    assert_eq!(count("ball diameter=0.065", 0.1 * MM), 1);
    // Each ball of the row covers 2 · sqrt(0.375 · 10.375) = 3.9 mm of the 90 mm between the ends, which cover 1.6 mm each.
    assert_eq!(count("capsule diameter=0.01 length=0.1", 0.25 * MM), 25);
    let torus = "torus ring_diameter=0.06 tube_diameter=0.01";
    assert_eq!(count(torus, 0.25 * MM), 52);
    // The rims have balls of about 1.2 mm, one ball per slice of the barrel.
    let barrel = "cylinder diameter=0.019 height=0.121";
    assert!(count(barrel, 0.25 * MM) <= 290);
    // Expected spheres: 12 edges at 5.66 e, then about 4 A / 8er spheres on 2 · 158 · 210 mm² and the four sides.
    assert!(count("box size=[0.158,0.06,0.21]", 0.5 * MM) <= 3_700);
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
    let rod = "cylinder diameter=0.004 height=0.1";
    let alone = pack(&solid(rod), 0.2 * MM).unwrap().n_spheres();
    let parts = ["ball diameter=0.06", rod].map(|text| part(text, [0.0; 3]));
    let both = Solid::new(parts.to_vec()).unwrap();
    let packed = pack(&both, 0.2 * MM).unwrap();
    let mut others = packed.spheres()[1..].iter();
    assert!(others.all(|s| s.center.length() >= 25. * MM));
    assert!(packed.n_spheres() < alone);
}

#[test]
fn dimensions_out_of_range_are_refused_by_name() {
    let cases = "ball diameter=nan | diameter: NaN m
        box size=[1,-2,3] | size: -2 m
        box size=[1,1,1] rounding=0.6 | rounding: 0.6 m; 0 m to 0.5 m
        capsule diameter=2 length=1 | length: 1 m; 2 m or more
        cone_frustum bottom_diameter=0 top_diameter=0 height=1 | top_diameter: 0 m; a finite length of at least 1e-9 m
        torus ring_diameter=1 tube_diameter=2 | ring_diameter: 1 m; 2 m or more
        tube outer_diameter=1 inner_diameter=1 height=1 | inner_diameter: 1 m; less than the outer diameter of 1 m
        lathe profile=[[0,0],[1,0]] | profile: 2 corners
        lathe profile=[[0,0],[-1,0],[0,1]] | profile: corner 2 left of the axis
        prism outline=[[0,0],[1,0],[nan,nan]] thickness=1 | outline: corner 3, which is not finite
        strand points=[[0,0,0]] diameters=[] | diameters: 1 points and 0 diameters
        strand points=[[0,0,0],[0,0,0]] diameters=[1,1] | points: point 2 as the one before
        box size=[1,1,1] rounding=1e-10 | rounding: 1e-10 m; zero, or a finite length of at least 1e-9 m
        tube outer_diameter=1 inner_diameter=0.9999999999 height=1 | inner_diameter: 0.9999999999 m; less than the outer
        prism outline=[[0,0],[1,0],[1,1e-10]] thickness=1 | outline: corner 2 repeated; at least three corners, 1e-9 m or
        strand points=[[0,0,0],[0,0,1e-320]] diameters=[1,1] | points: point 2 as the one before";
    for case in cases.lines() {
        let (text, expected) = case.trim().split_once(" | ").unwrap();
        let error = Solid::from_shape(shape(text)).unwrap_err().to_string();
        assert!(
            error.starts_with(expected),
            "expected `{expected}` in: {error}"
        );
    }
}

/// Shapes in which each length `?` may be the shortest one, beside lengths of centimetres.
const SHORT: [&str; 12] = [
    "ball diameter=?",
    "box size=[?,0.04,0.04]",
    "box size=[0.03,0.04,0.04] rounding=?",
    "cylinder diameter=0.05 height=?",
    "capsule diameter=? length=0.05",
    "cone_frustum bottom_diameter=0.05 top_diameter=? height=0.03",
    "torus ring_diameter=0.05 tube_diameter=?",
    "tube outer_diameter=0.05 inner_diameter=? height=0.03",
    "lathe profile=[[0,0],[0.05,0],[0.05,?],[0,?]]",
    "prism outline=[[0,0],[0.05,0],[0.02,0.05]] thickness=?",
    "hexagonal_prism across_flats=0.05 height=?",
    "strand points=[[0,0,0],[0.05,0,0]] diameters=[?,0.02]",
];

#[test]
fn the_shortest_lengths_are_packed_and_shorter_ones_are_refused() {
    for text in SHORT {
        for length in ["1e-320", "1e-160", "9.9e-10"] {
            let error = Solid::from_shape(shape(&text.replace('?', length)));
            let error = error.unwrap_err().to_string();
            assert!(error.contains("1e-9 m"), "{text}, {length}: {error}");
        }
        let solid = solid(&text.replace('?', "1e-9"));
        assert_packs(&solid, 0.25 * MM, MM, text);
        assert!(
            pack(&solid, 0.25 * MM).unwrap().n_spheres() < 100_000,
            "{text}"
        );
    }
}

/// Returns a random shape with lengths over four decades, for thin plates, needles, tiny and huge solids.
fn random_shape(rng: &mut impl Rng) -> String {
    let mut length = || MM * 10f64.powf(rng.gen_range(-1.0..2.5));
    let (a, b, c) = (length(), length(), length());
    let sum = a + b;
    match rng.gen_range(0..10) {
        0 => format!("ball diameter={a}"),
        1 => format!("box size=[{a},{b},{c}]"),
        2 => {
            let rounding = rng.gen_range(0.0..=0.5) * a.min(b).min(c);
            format!("box size=[{a},{b},{c}] rounding={rounding}")
        }
        3 => format!("cylinder diameter={a} height={b}"),
        4 => format!("capsule diameter={a} length={sum}"),
        5 => {
            let top = if rng.gen_bool(0.3) { 0.0 } else { b };
            format!("cone_frustum bottom_diameter={a} top_diameter={top} height={c}")
        }
        6 => format!("torus ring_diameter={sum} tube_diameter={a}"),
        7 => format!("tube outer_diameter={sum} inner_diameter={a} height={c}"),
        8 => {
            format!("strand points=[[0,0,0],[{a},{b},{c}],[-{b},{c},{a}]] diameters=[{c},{a},{b}]")
        }
        _ => format!(
            "prism outline=[[0,0],[{a},{}],[{},{}],[{},{b}]] thickness={c}",
            0.1 * b,
            0.5 * a,
            0.3 * b,
            0.6 * a
        ),
    }
}

#[test]
fn random_solids_pack_within_the_tolerance() {
    for case in 0..600 {
        let mut rng = Seed::new(2).named("packing").numbered(case).rng();
        let text = random_shape(&mut rng);
        let solid = solid(&text);
        let size = solid.bounds().size().max_element();
        let tolerance = size * 10f64.powf(rng.gen_range(-2.7..0.7));
        let spacing = (solid.bounds().size().length() / 60.0).min(20.0 * tolerance);
        assert_packs(&solid, tolerance, spacing, &format!("case {case}: {text}"));
    }
}
