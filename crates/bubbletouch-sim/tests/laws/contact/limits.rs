//! Limits of contact: extreme sizes, positions and steps. Each case has the behaviour that the guide's page on limits states.

use crate::double_double::Double;
use crate::scenes::{
    Scene, TAXEL, ball, direction, one_taxel, pressed, random_pose, rng, touched, union,
};
use crate::time_loop::time_loop;
use bubbletouch_sim::contact::{
    DamperState, GRAZING, Until, Workspace, relaxation_factor, spring_load,
};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::Sphere;
use bubbletouch_sim::world::{Grid, Patch, Phase, Taxel, Taxels, VelocityPlan};
use glam::{DQuat, DVec3};
use rand::Rng;

const GRID: Grid = Grid {
    nx: 9,
    ny: 7,
    pitch: 2e-3,
};

/// Returns a grid with a sphere.
fn scene(center: DVec3, radius: f64) -> Scene {
    let grid = Patch::grid(GRID, TAXEL).unwrap();
    Scene::new(grid, union([center], radius), Pose::IDENTITY)
}

/// Returns √(S² − b²) − h, computed with twice the digits of f64 from the exact inputs; `None` if b ≥ S.
fn exactly_needed(taxel: DVec3, radius: f64, sphere: &Sphere) -> Option<f64> {
    let [dx, dy, height] = [0, 1, 2].map(|k| Double::from(sphere.center[k]) - taxel[k].into());
    let reach = Double::from(radius) + sphere.radius.into();
    let left = reach * reach - (dx * dx + dy * dy);
    (left.round() > 0.0).then(|| (left.sqrt() - height).round())
}

#[test]
fn spheres_from_a_micrometre_to_a_kilometre_press_right_to_the_last_digits_of_their_size() {
    let mut n_touched = [0; 9];
    for case in 0..4000 {
        let mut rng = rng("sizes", case);
        let size = rng.gen_range(-6.0..3.0);
        let radius = 10f64.powf(size);
        let reach = radius + TAXEL.radius;
        // The contact is anywhere on the sphere above a random taxel, at most as deep as the stroke.
        let (x, y) = (rng.gen_range(-8e-3..8e-3), rng.gen_range(-6e-3..6e-3));
        let beside = direction(&mut rng) * rng.gen_range(0.0..0.9) * reach;
        let height = (reach * reach - beside.truncate().length_squared()).sqrt();
        let center =
            DVec3::new(x, y, height - rng.gen_range(0.0..TAXEL.stroke)) + beside.with_z(0.0);
        let scene = scene(center, radius);
        let object = Sphere { center, radius };
        let both = [pressed(scene.press(Until::Pose)), scene.touched()];
        for (taxel, &place) in scene.patch.layout().centers().iter().enumerate() {
            let exact = exactly_needed(place, TAXEL.radius, &object).unwrap_or(0.0);
            // Change of √(S² − b²) = δ + h due to the last bit of S².
            let up = (exact + center.z - place.z).max(1e-7 * reach);
            let rounding = 4.0 * f64::EPSILON * (reach * reach / up + center.length());
            let exact = exact.clamp(0.0, TAXEL.stroke);
            for found in both.each_ref().map(|found| found.deflections[taxel]) {
                let error = (found - exact).abs();
                assert!(
                    error <= rounding,
                    "case {case}, {radius} m: {found} for {exact}"
                );
            }
            n_touched[(size + 6.0) as usize] += usize::from(exact > 0.0);
        }
    }
    assert!(n_touched.iter().all(|&n| n > 100), "{n_touched:?}");
}

#[test]
fn a_million_metres_from_the_origin_a_press_is_the_same_to_the_bit() {
    // A copy of the scene a million metres away. Coordinates are multiples of 2⁻³⁰ m, so that they are also exact there.
    let exact = |v: DVec3| (v * 2f64.powi(30)).round() / 2f64.powi(30);
    let still = |pose: Pose| VelocityPlan::new(pose, Vec::new()).unwrap();
    for case in 0..200 {
        let mut rng = rng("far away", case);
        let center = exact(DVec3::new(
            rng.gen_range(-8e-3..8e-3),
            rng.gen_range(-6e-3..6e-3),
            rng.gen_range(8e-3..10e-3),
        ));
        let scene = scene(DVec3::ZERO, 1e-2);
        let turn = random_pose(&mut rng, 0.0).rotation;
        let patch = exact(direction(&mut rng));
        let object = exact(patch + turn * center);
        let away = 1e6 * direction(&mut rng).round();
        let [here, there] = [DVec3::ZERO, away].map(|away| {
            let plans = [patch, object].map(|at| still(Pose::new(turn, at + away)));
            time_loop(&scene, [&plans[..1], &plans[1..]], 1e-3, 1)
        });
        assert!(here.deflections[0].iter().any(|&d| d > 0.0), "case {case}");
        assert_eq!(here, there, "case {case}");
    }
}

#[test]
fn a_step_of_any_length_takes_the_damper_where_the_closed_form_says() {
    // Objects that jump: each frame is independent, except for the memory of the damper.
    let taxel = Taxel {
        damping: 0.3,
        ..TAXEL
    };
    let taxels = Taxels::Equal(taxel);
    let patch = Patch::grid(GRID, taxel).unwrap();
    let jumping = Scene::new(patch, ball(1e-2), Pose::IDENTITY);
    let mut state = DamperState::at_rest(GRID.n_taxels());
    let mut expected = vec![0.0; GRID.n_taxels()];
    let (mut n_through, mut n_pressed) = (0, 0);
    for case in 0..3000 {
        let mut rng = rng("jumps", case);
        let dt = 10f64.powf(rng.gen_range(-9.0..6.0));
        // Heights from far above the skin to far below it: twelve strokes in either direction.
        let height = rng.gen_range(-0.06..0.06);
        let place = DVec3::new(
            rng.gen_range(-8e-3..8e-3),
            rng.gen_range(-6e-3..6e-3),
            height,
        );
        let there = jumping.moved(&Pose::from_translation(place));
        let found = pressed(there.press(Until::Pose)).deflections;
        let behind = -taxel.stroke - taxel.radius;
        n_through += usize::from(height < behind);
        state.step(&taxels, dt, &found);
        let left = relaxation_factor(&taxel, dt);
        for (number, before) in expected.iter_mut().enumerate() {
            let (row, column) = (number / GRID.nx, number % GRID.nx);
            let at = DVec3::new(GRID.x(column), GRID.y(row), 0.0);
            let moved = Sphere {
                center: place,
                radius: 1e-2,
            };
            // The top of the sphere is as far above its middle as the bottom is below.
            let is_ahead = |needed: &f64| needed + 2.0 * height >= behind;
            let needed = exactly_needed(at, taxel.radius, &moved).filter(is_ahead);
            let pushed = needed.unwrap_or(0.0).clamp(0.0, taxel.stroke);
            n_pressed += usize::from(pushed > 0.0);
            *before = (*before * left).max(pushed);
            let error = (state.deflection[number] - *before).abs();
            assert!(error <= 1e-16, "step {case}, taxel {number}");
            assert!(state.force[number] >= 0.0 && state.force[number].is_finite());
        }
    }
    assert!(n_through > 1000 && n_pressed > 5000);
}

#[test]
fn what_jumps_through_the_skin_between_two_frames_is_not_felt_and_what_is_seen_to_go_through_stays_felt()
 {
    // Speed 0.1 m/s with steps of 1 s: from 50 mm above to 50 mm below in one step. Steps of 10 ms detect the contact.
    let fast = Phase {
        duration: 10.0,
        linear: DVec3::new(0.0, 0.0, -0.1),
        angular: DVec3::ZERO,
    };
    let start = Pose::from_translation(DVec3::new(0.0, 0.0, 0.15));
    let plans = [VelocityPlan::new(start, vec![fast]).unwrap()];
    let still = VelocityPlan::new(Pose::IDENTITY, Vec::new()).unwrap();
    let scene = scene(DVec3::ZERO, 1e-2);
    let still = [still];
    let felt = |dt: f64, n_frames| time_loop(&scene, [&still, &plans], dt, n_frames);
    assert!(felt(1.0, 3).deflections.concat().iter().all(|&d| d == 0.0));
    let fine = felt(0.01, 300);
    assert!(fine.n_saturated > 0 && fine.deflections.concat().contains(&TAXEL.stroke));
    let last = scene.moved(&Pose::from_translation(DVec3::new(0.0, 0.0, -0.15)));
    assert_eq!(
        pressed(last.press(Until::Pose)).deepest(),
        0.0,
        "behind the substrate"
    );
    let deep = pressed(scene.press(Until::Depth(0.2)));
    assert_eq!(fine.deflections[299], deep.deflections);
}

#[test]
fn a_thin_needle_or_sheet_presses_as_deep_as_any() {
    for thickness in [1e-6, 1e-5, 1e-4, 1e-3] {
        // Spheres in a vertical row, 20 mm high.
        let along = |k: u32| DVec3::new(0.0, 0.0, 20e-3 * f64::from(k) / 400.0);
        let needle = union((0..=400).map(along), 0.5 * thickness);
        let scene = Scene::new(Patch::grid(GRID, TAXEL).unwrap(), needle, Pose::IDENTITY);
        let press = |depth: f64| {
            let found = pressed(scene.press(Until::Depth(depth)));
            (
                found.deflections[GRID.n_taxels() / 2],
                found.counts().n_saturated,
            )
        };
        let (middle, _) = press(2e-3);
        assert!((middle - 2e-3).abs() < 1e-15, "{thickness} m: {middle}");
        // If the patch is pressed past the stroke, only the end of the object is behind the substrate. The taxel is still saturated.
        assert_eq!(press(10e-3), (TAXEL.stroke, 1), "{thickness} m");
    }
}

#[test]
fn a_saturated_skin_is_counted_and_refuses_more_force_than_its_springs_have() {
    let n = GRID.n_taxels();
    let all = n as f64 * TAXEL.stiffness * TAXEL.stroke;
    for radius in [0.5, 10.0, 1e3] {
        let scene = scene(DVec3::new(0.0, 0.0, radius + 0.01), radius);
        for share in [1e-9, 0.3, 0.999, 1.0] {
            let found = pressed(scene.press(Until::Force(share * all)));
            // Change of the total spring force due to the last bits of the object's height.
            let known = n as f64 * TAXEL.stiffness * 8.0 * f64::EPSILON * radius;
            let error = (found.spring_force(TAXEL.stiffness) - share * all).abs();
            assert!(
                error <= 1e-12 * share * all + known,
                "{radius} m, {share}: {error}"
            );
        }
        let past = scene
            .press(Until::Force(1.001 * all))
            .run(&mut Workspace::new());
        let error = past.unwrap_err().to_string();
        let most = format!("up to {all:.6} N");
        assert!(
            error.contains(&most) && error.contains("at their stroke"),
            "{error}"
        );
        let deep = pressed(scene.press(Until::Depth(0.1))).counts();
        assert_eq!((deep.n_touched, deep.n_saturated), (n, n));
        let there = scene.moved(&Pose::from_translation(-deep.travel * DVec3::Z));
        let load = spring_load(&scene.patch, &there.touched().contacts);
        assert_eq!(load.saturated_share, 1.0);
        assert!((load.spring_force / all - 1.0).abs() < 1e-12);
    }
}

#[test]
fn grazing_flanks_push_with_a_bounded_force_and_are_counted() {
    let skin = one_taxel();
    let mut n_grazing = 0;
    for case in 0..2000 {
        let mut rng = rng("grazing", case);
        let radius = 10f64.powf(rng.gen_range(-4.0..1.0));
        let reach = radius + TAXEL.radius;
        // Cosine of the contact normal, from 1e-8 to 1.
        let cosine = 10f64.powf(rng.gen_range(-8.0..0.0));
        let beside = reach * (1.0 - cosine * cosine).sqrt();
        let deflection = rng.gen_range(1e-6..TAXEL.stroke);
        let height = reach * cosine - deflection;
        if height < -TAXEL.stroke - TAXEL.radius {
            continue;
        }
        let flank = union([DVec3::new(beside, 0.0, height)], radius);
        let found = touched(&skin, &[flank.into()], &[Pose::IDENTITY]);
        // Rounding may move the shallowest flanks out of reach entirely.
        let [contact] = found.contacts[..] else {
            assert!(cosine < 1e-7, "case {case}: {cosine}");
            continue;
        };
        let force = TAXEL.stiffness * contact.deflection;
        let push = contact.push(force).force;
        assert!(
            push.length() <= force / GRAZING * (1.0 + 1e-12),
            "case {case}"
        );
        if cosine > 1.1 * GRAZING {
            // The force F = f n_c / (n_c·n) equals the spring force along the axis.
            assert!((push.z / force - 1.0).abs() < 1e-9, "case {case}: {push}");
        }
        assert_eq!(contact.is_grazing(), contact.cosine < GRAZING);
        n_grazing += usize::from(contact.is_grazing());
    }
    assert!(n_grazing > 500, "{n_grazing}");
}

#[test]
fn a_taxel_exactly_between_two_spheres_is_pushed_as_far_as_each_of_them_needs() {
    let skin = one_taxel();
    for case in 0..500 {
        let mut rng = rng("between", case);
        let radius = 10f64.powf(rng.gen_range(-3.0..1.0));
        let reach = radius + TAXEL.radius;
        let beside = rng.gen_range(0.0..0.99) * reach;
        let up = (reach * reach - beside * beside).sqrt();
        let height = up - rng.gen_range(0.0..1.0) * TAXEL.stroke;
        let turn = DQuat::from_rotation_z(rng.gen_range(0.0..6.0));
        let pair = union(
            [beside, -beside].map(|x| turn * DVec3::new(x, 0.0, height)),
            radius,
        );
        let exact = exactly_needed(DVec3::ZERO, TAXEL.radius, &pair.spheres()[0]);
        let exact = exact.unwrap().clamp(0.0, TAXEL.stroke);
        let found = touched(&skin, &[pair.into()], &[Pose::IDENTITY]).deepest();
        assert!(
            (found - exact).abs() <= 8.0 * f64::EPSILON * reach,
            "case {case}"
        );
    }
}
