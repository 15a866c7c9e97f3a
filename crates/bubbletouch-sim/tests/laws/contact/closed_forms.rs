//! Presses with known results: balls, boxes, capsules, walls, and one taxel with one triangle against a search.

use crate::mesh_shapes::{cuboid, icosphere, joined};
use crate::scenes::{
    Scene, TAXEL, ball, direction, grid, mesh, one_taxel, pressed, random_pose, rng, skin, touched,
    union,
};
use crate::time_loop::time_loop;
use bubbletouch_sim::contact::{Until, spring_load, stopping_height};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::Triangle;
use bubbletouch_sim::objects::{MeshModel, Model};
use bubbletouch_sim::world::{Layout, Patch, Phase, RestPoses, VelocityPlan};
use glam::{DQuat, DVec2, DVec3};
use rand::Rng;
use std::f64::consts::TAU;

/// Returns a triangle of size 1: arbitrary, thin, collinear, a point, vertical, horizontal, or with a vertical edge.
fn odd_triangle(rng: &mut impl Rng, kind: u64) -> Triangle {
    let [a, mut b, mut c] = [0; 3].map(|_| direction(rng) * rng.gen_range(0.1..1.0));
    match kind % 8 {
        1 => c = a + 0.3 * (b - a) + 10f64.powf(rng.gen_range(-12.0..-2.0)) * direction(rng),
        2 => c = a + rng.gen_range(-1.0..2.0) * (b - a),
        3 => (b, c) = (a, a),
        4 => c = a + DVec3::new(0.7 * (b - a).x, 0.7 * (b - a).y, 0.8),
        5 => (b.z, c.z) = (a.z, a.z),
        6 => b = a + DVec3::Z * rng.gen_range(0.1..1.0),
        _ => {}
    }
    Triangle([a, b, c])
}

/// Returns the lowest z at which a ball at (x, y) is a radius away from the triangle. Sampling finds a point that is nearer, and bisection follows below it.
/// The distance to a convex set is convex along the line.
pub(super) fn stopping_height_by_search(
    triangle: &Triangle,
    radius: f64,
    at: DVec2,
) -> Option<f64> {
    let distance = |z: f64| {
        let point = at.extend(z);
        triangle.closest(point).0.distance(point)
    };
    let bounds = triangle.bounds();
    let (bottom, top) = (bounds.min.z - 2.0 * radius, bounds.max.z + 2.0 * radius);
    let (mut low, mut high) = (bottom, top);
    for _ in 0..150 {
        let (l, h) = ((2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0);
        // Equal values count as lower: where the distance is flat, the lower position is as near.
        match distance(l) <= distance(h) {
            true => high = h,
            false => low = l,
        }
    }
    let nearest = 0.5 * (low + high);
    if distance(nearest) >= radius {
        return None;
    }
    let (mut outside, mut inside) = (bottom, nearest);
    for _ in 0..80 {
        let middle = 0.5 * (outside + inside);
        match distance(middle) >= radius {
            true => outside = middle,
            false => inside = middle,
        }
    }
    Some(inside)
}

#[test]
fn a_taxel_stops_at_a_triangle_where_a_search_says() {
    let (mut n_met, mut worst) = (0, 0.0_f64);
    for case in 0..8_000 {
        let mut rng = rng("stop", case);
        let size = 10f64.powf(rng.gen_range(-3.5..-0.5));
        let triangle = Triangle(odd_triangle(&mut rng, case).0.map(|v| size * v));
        let radius = 10f64.powf(rng.gen_range(-3.5..-2.0));
        let weights = DVec3::new(rng.r#gen(), rng.r#gen(), rng.r#gen());
        let [a, b, c] = triangle.0;
        let under = (weights.x * a + weights.y * b + weights.z * c) / weights.element_sum();
        let away = direction(&mut rng) * rng.gen_range(0.0..1.5) * radius;
        let at = (under + away).truncate();
        let found = stopping_height(&triangle, radius, at);
        let searched = stopping_height_by_search(&triangle, radius, at);
        let place = format!("case {case}: {found:?} {searched:?} {triangle:?}");
        if let (Some(found), Some(searched)) = (found, searched) {
            n_met += 1;
            worst = worst.max((found - searched).abs());
            assert!((found - searched).abs() < 1e-9, "{place}");
        } else if found.is_some() != searched.is_some() {
            // At the rim the height has no finite slope, and the ball misses the triangle only by rounding.
            let [larger, smaller] = [1e-12, -1e-12]
                .map(|more| stopping_height_by_search(&triangle, radius * (1.0 + more), at));
            assert!(larger.is_some() != smaller.is_some(), "{place}");
        }
    }
    assert!(n_met > 4_000, "{n_met}");
    assert!(worst > 0.0, "{worst}");
}

#[test]
fn a_ball_pressed_on_the_array_leaves_its_cap() {
    let (radius, depth) = (0.05, 2e-3);
    let start = Pose::from_translation(0.3 * DVec3::Z);
    let scene = Scene::new(grid(33, 33, 1e-3), ball(radius), start);
    let found = pressed(scene.press(Until::Depth(depth)));
    assert!((found.travel() - (0.3 - radius - TAXEL.radius + depth)).abs() < 1e-15);
    let reach = radius + TAXEL.radius;
    for (got, center) in found.deflections.iter().zip(scene.patch.layout().centers()) {
        let cap = ((reach * reach - center.length_squared()).sqrt() - reach + depth).max(0.0);
        assert!((got - cap).abs() < 1e-15, "{got} and {cap}");
    }
}

#[test]
fn saturation_is_counted_and_stops_at_the_stroke() {
    let scene = Scene::new(
        grid(9, 9, 2e-3),
        ball(10.0),
        Pose::from_translation(10.0 * DVec3::Z),
    );
    let at_stroke = pressed(scene.press(Until::Depth(TAXEL.stroke)));
    assert_eq!(at_stroke.counts().n_saturated, 0);
    let beyond = pressed(scene.press(Until::Depth(0.02)));
    assert_eq!(
        (beyond.counts().n_touched, beyond.counts().n_saturated),
        (81, 81)
    );
    assert!(beyond.deflections.iter().all(|&d| d == TAXEL.stroke));
}

#[test]
fn a_ball_leaves_taxel_by_taxel_on_its_way_through_the_substrate() {
    let scene = |z| {
        Scene::new(
            grid(3, 3, 2e-3),
            ball(0.02),
            Pose::from_translation(z * DVec3::Z),
        )
    };
    let press = |z| pressed(scene(z).press(Until::Pose)).counts();
    // With S = 21 mm, the substrate leaves the sphere at three heights: over the middle, the sides and the corners.
    let leaves = |b: f64| -0.006 - (0.021_f64.powi(2) - b * b).sqrt();
    let heights = [2e-3 * 2_f64.sqrt(), 2e-3, 0.0].map(leaves);
    for (height, n_left) in heights.into_iter().zip([9, 5, 1]) {
        assert_eq!(press(height + 1e-9).n_saturated, n_left, "{height} m");
        assert!(press(height - 1e-9).n_touched < n_left, "{height} m");
    }
    assert_eq!(press(heights[2] - 1e-9).n_touched, 0);
}

#[test]
fn pressure_has_its_centre_under_the_ball_and_says_what_is_saturated() {
    let skin = skin(Layout::disc(0.02, 1e-3).unwrap(), TAXEL);
    let objects = [ball(0.05).into()];
    let load = |depth: f64| {
        let pose = Pose::from_translation((0.05 + TAXEL.radius - depth) * DVec3::Z);
        spring_load(&skin, &touched(&skin, &objects, &[pose]).contacts)
    };
    let light = load(1e-3);
    assert!(light.center_of_pressure.unwrap().length() < 1e-15);
    assert_eq!(light.saturated_share, 0.0);
    assert!((light.on_object.force.z - light.spring_force).abs() < 1e-12);
    assert!(light.on_object.force.truncate().length() < 1e-12);
    assert_eq!(load(0.03).saturated_share, 1.0);
    let none = load(-1e-3);
    assert_eq!((none.spring_force, none.center_of_pressure), (0.0, None));
}

#[test]
fn of_two_spheres_that_push_a_taxel_the_same_the_first_decides() {
    let skin = one_taxel();
    let row = |xs: &[f64]| union(xs.iter().map(|&x| DVec3::new(x, 0.0, 4e-3)), 5e-3);
    for x in [2e-3, -2e-3] {
        let objects = [row(&[x, -x]).into(), row(&[-x]).into()];
        let found = touched(&skin, &objects, &[Pose::IDENTITY; 2]);
        let [contact] = found.contacts[..] else {
            panic!("one taxel is touched")
        };
        assert_eq!((contact.object, contact.part), (0, 0));
        assert!(contact.normal.x * x < 0.0, "away from the first sphere");
    }
}

#[test]
fn a_box_pressed_flat_is_flat_and_its_edge_is_round() {
    // The box extends from x = −10.4 mm to 10.4 mm, and upwards from z = 0.
    let half = DVec3::new(10.4e-3, 0.02, 0.05);
    let start = Pose::from_translation(0.05 * DVec3::Z);
    let scene = Scene::new(grid(41, 1, 1e-3), mesh(cuboid(half)), start);
    let found = pressed(scene.press(Until::Depth(2e-3)));
    assert!((found.travel() - (2e-3 - TAXEL.radius)).abs() < 1e-16);
    for (found, center) in found.deflections.iter().zip(scene.patch.layout().centers()) {
        let beside: f64 = (center.x.abs() - 10.4e-3).max(0.0);
        // A taxel 0.6 mm beside the edge stops 0.8 mm below the edge, whereas a taxel under the face stops 1 mm below it.
        let exact = if beside < TAXEL.radius {
            2e-3 - TAXEL.radius + (TAXEL.radius.powi(2) - beside * beside).sqrt()
        } else {
            0.0
        };
        assert!((found - exact).abs() < 1e-15, "{center}: {found} {exact}");
    }
}

#[test]
fn a_finer_ball_feels_like_a_sphere() {
    let turn = DQuat::from_scaled_axis(DVec3::new(0.3, 0.2, 0.1));
    let pose = Pose::new(turn, DVec3::new(3e-4, 5e-4, 0.04));
    let felt = |object: Model| {
        let scene = Scene::new(grid(32, 32, 2e-3), object, pose);
        pressed(scene.press(Until::Travel(4e-3))).deflections
    };
    let exact = felt(ball(0.04).into());
    let mut last = f64::INFINITY;
    for level in 1..7 {
        let found = felt(mesh(icosphere(0.04, level)));
        let differences: Vec<f64> = exact.iter().zip(&found).map(|(a, b)| a - b).collect();
        assert!(
            differences.iter().all(|&off| off >= 0.0),
            "the mesh is inscribed"
        );
        let worst = differences.into_iter().fold(0.0, f64::max);
        assert!(worst < 0.4 * last, "level {level}: {worst} after {last}");
        last = worst;
    }
    assert!(last < 2e-5, "{last}");
}

#[test]
fn balls_as_spheres_and_as_fine_meshes_press_a_fingertip_nearly_the_same() {
    let skin = skin(Layout::sphere_cap(0.02, 1.5, 2e-3).unwrap(), TAXEL);
    let pose = Pose::from_translation(DVec3::new(0.02, 0.01, 0.043));
    let [a, b] = [mesh(icosphere(0.03, 6)), ball(0.03).into()]
        .map(|model: Model| touched(&skin, &[model], &[pose]));
    let pairs = a.deflections.iter().zip(&b.deflections);
    let largest = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(largest < 2e-5, "{largest}");
    let [a, b] = [a, b].map(|found| spring_load(&skin, &found.contacts));
    assert!(b.spring_force > 1.0);
    let difference = a.on_object.force - b.on_object.force;
    assert!(difference.length() < 0.02 * b.spring_force, "{difference}");
}

#[test]
fn a_mesh_behind_the_substrate_does_not_count_unless_it_was_pressed_through_the_skin() {
    let scene = Scene::new(
        grid(8, 8, 2e-3),
        mesh(cuboid(DVec3::splat(0.01))),
        Pose::IDENTITY,
    );
    let at = |height: f64| scene.moved(&Pose::from_translation(height * DVec3::Z));
    let n_touched = |height| pressed(at(height).press(Until::Pose)).counts().n_touched;
    // The top of the mesh is at height + 10 mm. A taxel that rests on it is 1 mm higher, and the limit is 6 mm behind the skin.
    assert_eq!(n_touched(-0.01701), 0);
    assert_eq!(n_touched(-0.01699), 64);
    let through = pressed(at(0.05).press(Until::Depth(0.05))).counts();
    assert_eq!((through.n_touched, through.n_saturated), (64, 64));
    // The patch moves 60 mm in steps of a millimetre.
    let down = Phase {
        duration: 0.1,
        linear: -DVec3::Z,
        angular: DVec3::ZERO,
    };
    let still = VelocityPlan::new(Pose::IDENTITY, Vec::new()).unwrap();
    let plan = VelocityPlan::new(Pose::from_translation(0.05 * DVec3::Z), vec![down]).unwrap();
    let frames = time_loop(&scene, [&[still], &[plan]], 1e-3, 100);
    let last = &frames.deflections[99];
    assert!(last.iter().all(|&deflection| deflection == TAXEL.stroke));
}

#[test]
fn a_mesh_lies_on_the_table_like_its_solid() {
    let brick = mesh(cuboid(DVec3::new(0.05, 0.03, 0.01)));
    assert!(brick.center_of_mass().length() < 1e-15);
    let poses = RestPoses::Stable.poses(&brick);
    let heights: Vec<f64> = poses.iter().map(|pose| 0.5 * pose.height).collect();
    let is_flat = (heights[0] - 0.01).abs() < 1e-9 && poses[0].probability > 0.3;
    assert!(is_flat, "{heights:?}");
    for half in [0.01, 0.03, 0.05] {
        let has_face = heights.iter().any(|h| (h - half).abs() < 1e-9);
        assert!(has_face, "{half}: {heights:?}");
    }
    let ball = mesh(icosphere(0.03, 3).moved(&Pose::from_translation(DVec3::X)));
    assert!((ball.center_of_mass() - DVec3::X).length() < 1e-12);
    assert!((ball.bounds().size() - 0.06).abs().max_element() < 1e-3);
}

/// Returns a closed skin around a forearm with a level z axis.
fn forearm() -> Patch {
    skin(Layout::cylinder(0.03, 0.1, TAU, 5e-3).unwrap(), TAXEL)
}

#[test]
fn what_a_forearm_lies_on_does_not_press_its_other_side() {
    // The top of the mesh is at x = −0.029. Taxels rest at x = −0.03 with a radius of 1 mm, so they are pushed by up to 2 mm.
    let pose = Pose::from_translation(DVec3::new(-0.039, 0.0, 0.0));
    let table = mesh(cuboid(DVec3::new(0.01, 1.0, 1.0)));
    let scene = Scene::new(forearm(), table, pose);
    let found = scene.touched();
    let counts = found.counts();
    assert!(
        counts.n_touched > 50 && counts.n_saturated == 0,
        "{counts:?}"
    );
    for contact in &found.contacts {
        let axis = scene.patch.layout().axes()[contact.taxel];
        assert!(axis.x < -0.9, "{axis}");
        // A taxel whose axis is inclined by θ to a plane moves back until it is a radius away from the plane.
        let needed = (TAXEL.radius - 0.029) / -axis.x + 0.03;
        assert!((contact.needed - needed).abs() < 1e-12);
        assert!((contact.normal - DVec3::X).length() < 1e-9);
    }
}

#[test]
fn walls_on_both_sides_of_a_forearm_press_only_their_own_sides() {
    let wall = cuboid(DVec3::new(0.01, 1.0, 1.0));
    let sides = [-0.039, 0.039].map(|x| wall.moved(&Pose::from_translation(x * DVec3::X)));
    let scene = Scene::new(forearm(), mesh(joined(&sides)), Pose::IDENTITY);
    let found = scene.touched();
    let counts = found.counts();
    assert!(
        counts.n_touched > 100 && counts.n_saturated == 0,
        "{counts:?}"
    );
    let load = spring_load(&scene.patch, &found.contacts);
    assert!(load.on_object.force.length() < 1e-9 * load.spring_force);
}

#[test]
fn a_taxel_whose_substrate_is_inside_of_a_mesh_is_saturated() {
    for solid in [cuboid(DVec3::splat(0.05)), icosphere(0.05, 3)] {
        let found = Scene::new(grid(5, 5, 2e-3), mesh(solid), Pose::IDENTITY).touched();
        assert_eq!(
            (found.counts().n_touched, found.counts().n_saturated),
            (25, 25)
        );
        assert!(found.contacts.iter().all(|c| c.needed > 0.04));
    }
}

#[test]
fn a_capsule_without_length_is_a_sphere() {
    let mut n_touched = 0;
    let fingertip = skin(Layout::sphere_cap(0.015, 1.4, 3e-3).unwrap(), TAXEL);
    for case in 0..400 {
        let mut rng = rng("capsule as ball", case);
        let radius = rng.gen_range(1e-3..2e-2);
        // The poses include objects that cross the skin or lie behind the substrate.
        let distance = rng.gen_range(0.0..2.5e-2);
        let pose = random_pose(&mut rng, distance);
        let capsule: Model = MeshModel::capsule(radius, 0.0).unwrap().into();
        for patch in [grid(14, 11, 2e-3), fingertip.clone()] {
            let [found, exact] = [capsule.clone(), ball(radius).into()]
                .map(|model| Scene::new(patch.clone(), model, pose).touched().deflections);
            crate::scenes::assert_close(&found, &exact, 1e-12, &format!("case {case}"));
            n_touched += exact.iter().filter(|d| **d > 0.0).count();
        }
    }
    assert!(n_touched > 5_000, "{n_touched}");
}

#[test]
fn a_lying_capsule_has_a_closed_form() {
    let (radius, length) = (8e-3, 0.02);
    let capsule = MeshModel::capsule(radius, length).unwrap();
    let turn = DQuat::from_rotation_arc(DVec3::Z, DVec3::X);
    let height = 6e-3;
    let scene = Scene::new(
        grid(14, 11, 2e-3),
        capsule,
        Pose::new(turn, height * DVec3::Z),
    );
    for found in [pressed(scene.press(Until::Pose)), scene.touched()] {
        for (found, center) in found.deflections.iter().zip(scene.patch.layout().centers()) {
            let beyond = (center.x.abs() - 0.5 * length).max(0.0);
            let q = (radius + TAXEL.radius).powi(2) - beyond * beyond - center.y * center.y;
            let exact = if q > 0.0 {
                (q.sqrt() - height).clamp(0.0, TAXEL.stroke)
            } else {
                0.0
            };
            assert!((found - exact).abs() < 1e-15, "{found} {exact}");
        }
    }
}

#[test]
fn a_rounded_box_rests_on_its_rounded_faces_and_bad_sizes_are_refused() {
    let half = DVec3::new(0.03, 0.02, 0.01);
    let rounded: Model = MeshModel::rounded(cuboid(half), 5e-3).unwrap().into();
    assert!((rounded.bounds().size() - 2.0 * (half + 5e-3)).length() < 1e-15);
    let height = 0.5 * RestPoses::Stable.poses(&rounded)[0].height;
    assert!((height - 0.015).abs() < 1e-9, "{height}");
    let at = |height: f64| {
        let pose = Pose::from_translation(height * DVec3::Z);
        Scene::new(grid(14, 11, 2e-3), rounded.clone(), pose).touched()
    };
    let found = at(0.0149);
    assert!(found.deflections.iter().all(|d| (d - 1.1e-3).abs() < 1e-15));
    // The substrate is inside the box, in its rounding below, or above the box.
    for (height, deflection) in [(0.0, 5e-3), (0.008, 5e-3), (-0.0219, 5e-3), (-0.0221, 0.0)] {
        let found = at(height).deflections;
        assert!(
            found.iter().all(|d| *d == deflection),
            "{height}: {found:?}"
        );
    }
    for bad in [-1e-9, f64::NAN, f64::INFINITY] {
        assert!(MeshModel::rounded(cuboid(half), bad).is_err());
        assert!(MeshModel::capsule(0.01, bad).is_err() && MeshModel::capsule(bad, 0.01).is_err());
    }
}
