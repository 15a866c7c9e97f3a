//! Laws of free objects. At rest all forces balance, wherever the world's origin is; otherwise the object is reported as escaped.

use super::balance_limits::{height_of_formula, needed};
use crate::scenes::{ball, bed, one_taxel, touched, union};
use bubbletouch_sim::contact::equilibrium::{
    Equilibrium, EquilibriumSolver, FreeObject, Outcome, PlacedSkin,
};
use bubbletouch_sim::contact::spring_load;
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Sphere, SphereUnion};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::world::{Patch, Taxel};
use glam::{DQuat, DVec3};
use rand::Rng;
use rayon::prelude::*;

const G: f64 = 9.81;
const DOWN: DVec3 = DVec3::new(0.0, 0.0, -G);

/// Returns the equilibrium on a skin that is at the origin.
fn on(patch: &Patch, object: &FreeObject, start: &Pose) -> Equilibrium {
    equilibrium(object, &[PlacedSkin::new(patch, Pose::IDENTITY)], start)
}

fn equilibrium(object: &FreeObject, skins: &[PlacedSkin], start: &Pose) -> Equilibrium {
    EquilibriumSolver::new()
        .solve(object, skins, DOWN, start)
        .unwrap()
}

fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::from_translation(DVec3::new(x, y, z))
}

#[test]
fn a_ball_rests_as_deep_as_its_weight_asks() {
    let (radius, mass, stiffness) = (0.03, 0.05, 100.0);
    let patch = bed(32, stiffness);
    let union = ball(radius);
    let object = FreeObject::new(&union, mass, DVec3::ZERO).unwrap();
    let rest = on(&patch, &object, &at(1e-3, 1e-3, 0.05));
    assert_eq!(rest.outcome, Outcome::AtRest);
    let place = rest.pose.translation;
    let height = height_of_formula(&patch, &union, place, mass * G);
    assert!((place.z - height).abs() < 1e-9, "{} {height}", place.z);
}

#[test]
fn forces_balance_for_every_weight_and_stiffness() {
    let union = ball(0.03);
    for mass in [1e-3, 1e-2, 1.0, 100.0, 1000.0] {
        for stiffness in [1.0, 1e2, 1e4, 1e6] {
            let object = FreeObject::new(&union, mass, DVec3::new(2e-3, 0.0, -5e-3)).unwrap();
            let patch = bed(64, stiffness);
            let skins = [PlacedSkin::new(&patch, Pose::IDENTITY)];
            let rest = equilibrium(&object, &skins, &at(0.3e-3, 0.2e-3, 0.04));
            let case = format!("{mass} kg on {stiffness} N/m: {rest:?}");
            assert_eq!(rest.outcome, Outcome::AtRest, "{case}");
            assert!(rest.imbalance <= 1e-6, "{case}");
            assert!((rest.force.z / (mass * G) - 1.0).abs() <= 1e-6, "{case}");
        }
    }
}

/// The press kernel and the spring load must confirm the forces at the pose that the solver found.
#[test]
fn the_skin_feels_the_weight_that_rests_on_it() {
    let patch = bed(48, 150.0);
    let mut rng = Seed::new(3).named("weight").rng();
    let mut random = || DVec3::from_array(std::array::from_fn(|_| rng.gen_range(-1.0..1.0)));
    let union = union((0..30).map(|_| 0.015 * random()), 8e-3);
    let mass = 0.08;
    let object = FreeObject::new(&union, mass, union.center_of_mass()).unwrap();
    let rest = on(&patch, &object, &at(0.0, 0.0, 0.06));
    assert_eq!(rest.outcome, Outcome::AtRest);
    let found = touched(&patch, &[union.into()], &[rest.pose]);
    let load = spring_load(&patch, &found.contacts);
    // For taxels between two spheres, only one sphere counts as deciding, so the lateral forces may differ slightly.
    assert!(
        (load.spring_force / (mass * G) - 1.0).abs() < 1e-6,
        "{load:?}"
    );
    assert_eq!(found.contacts.len(), rest.n_touched);
}

#[test]
fn moving_the_whole_world_moves_the_rest() {
    let patch = bed(32, 80.0);
    let sphere = |x: f64, y: f64, z: f64, radius: f64| Sphere {
        center: DVec3::new(x, y, z),
        radius,
    };
    let spheres = [
        sphere(-0.01, 0.0, 0.0, 0.012),
        sphere(0.012, 0.003, 0.0, 0.01),
        sphere(0.0, -0.012, 0.004, 0.011),
    ];
    let union = SphereUnion::new(spheres.to_vec()).unwrap();
    let object = FreeObject::new(&union, 0.06, DVec3::new(0.0, -2e-3, 1e-3)).unwrap();
    let start = at(1.3e-3, -0.7e-3, 0.03);
    let here = on(&patch, &object, &start);
    assert_eq!(here.outcome, Outcome::AtRest);
    let world = Pose::new(
        DQuat::from_euler(glam::EulerRot::XYZ, 0.7, -1.1, 2.0),
        DVec3::new(3.0, -2.0, 1.0),
    );
    let skins = [PlacedSkin::new(&patch, world)];
    let moved = world.compose(&start);
    let there = EquilibriumSolver::new()
        .solve(&object, &skins, world.transform_vector(DOWN), &moved)
        .unwrap();
    assert_eq!(there.outcome, Outcome::AtRest);
    let back = world.inverse().compose(&there.pose);
    assert!(
        (back.translation - here.pose.translation).length() < 1e-8,
        "{back:?} {here:?}"
    );
    assert!(back.rotation.angle_between(here.pose.rotation) < 1e-6);
}

#[test]
fn two_skins_in_a_v_carry_a_ball_together() {
    let patch = bed(32, 100.0);
    let slope = std::f64::consts::FRAC_PI_4;
    let side = |sign: f64| {
        let rotation = DQuat::from_rotation_y(-sign * slope);
        Pose::new(
            rotation,
            rotation * DVec3::new(0.0, 0.0, 0.0) + DVec3::new(sign * 0.025, 0.0, 0.025),
        )
    };
    let skins = [
        PlacedSkin::new(&patch, side(1.0)),
        PlacedSkin::new(&patch, side(-1.0)),
    ];
    let union = ball(0.02);
    let mass = 0.1;
    let object = FreeObject::new(&union, mass, DVec3::ZERO).unwrap();
    let rest = equilibrium(&object, &skins, &at(0.0, 1e-3, 0.08));
    assert_eq!(rest.outcome, Outcome::AtRest);
    assert!(rest.imbalance < 1e-6);
    assert!(rest.pose.translation.x.abs() < 1.1e-3, "{rest:?}");
    let sum: f64 = skins
        .iter()
        .map(|skin| {
            let pose = skin.world_from_patch.inverse().compose(&rest.pose);
            let found = touched(&patch, &[union.clone().into()], &[pose]);
            let force = spring_load(&patch, &found.contacts).on_object.force;
            (skin.world_from_patch.rotation * force).z
        })
        .sum();
    assert!((sum / (mass * G) - 1.0).abs() < 1e-6, "{sum}");
}

#[test]
fn a_ball_on_a_slope_rolls_off_downhill() {
    let patch = bed(24, 500.0);
    for (tilt, turn) in [(0.6, 0.0), (0.5, 1.0), (0.7, 2.5)] {
        let rotation = DQuat::from_rotation_z(turn) * DQuat::from_rotation_y(tilt);
        let skins = [PlacedSkin::new(&patch, Pose::from_rotation(rotation))];
        let union = ball(0.03);
        let object = FreeObject::new(&union, 0.05, DVec3::ZERO).unwrap();
        let rest = equilibrium(&object, &skins, &at(0.0, 0.0, 0.06));
        let downhill = (rotation * DVec3::X).with_z(0.0).normalize();
        let Outcome::Escaped { direction } = rest.outcome else {
            panic!("{rest:?}");
        };
        assert!(direction.dot(downhill) > 0.9, "{direction} for {downhill}");
        assert_eq!(rest.n_touched, 0);
    }
}

#[test]
fn what_misses_the_skin_falls_and_says_so() {
    let patch = bed(8, 100.0);
    let union = ball(0.01);
    let object = FreeObject::new(&union, 0.01, DVec3::ZERO).unwrap();
    let rest = on(&patch, &object, &at(0.5, 0.0, 0.1));
    let nothing = equilibrium(&object, &[], &at(0.0, 0.0, 0.1));
    let down = Outcome::Escaped {
        direction: -DVec3::Z,
    };
    assert_eq!([rest.outcome, nothing.outcome], [down; 2]);
}

#[test]
fn a_ball_on_the_point_of_a_single_taxel_does_not_stay_there() {
    let patch = one_taxel();
    let union = ball(0.02);
    let object = FreeObject::new(&union, 0.01, DVec3::ZERO).unwrap();
    // Exactly above the middle the forces balance at some height, which is a saddle of the energy.
    let rest = on(&patch, &object, &at(0.0, 0.0, 0.05));
    assert!(matches!(rest.outcome, Outcome::Escaped { .. }), "{rest:?}");
}

#[test]
fn at_rest_it_stays_and_nearby_it_returns() {
    let patch = bed(32, 100.0);
    let skins = [PlacedSkin::new(&patch, Pose::IDENTITY)];
    let union = ball(0.03);
    let object = FreeObject::new(&union, 0.3, DVec3::new(0.0, 0.0, -0.01)).unwrap();
    let mut balancer = EquilibriumSolver::new();
    let first = balancer
        .solve(&object, &skins, DOWN, &at(0.4e-3, 0.1e-3, 0.04))
        .unwrap();
    let again = balancer.solve(&object, &skins, DOWN, &first.pose).unwrap();
    assert!((again.pose.translation - first.pose.translation).length() < 1e-9);
    assert!(again.n_steps <= 6, "{again:?}");
    let lifted = Pose::new(
        first.pose.rotation,
        first.pose.translation + 1e-3 * DVec3::Z,
    );
    let back = balancer.solve(&object, &skins, DOWN, &lifted).unwrap();
    assert!((back.pose.translation.z - first.pose.translation.z).abs() < 1e-6);
}

#[test]
fn others_that_push_the_taxels_take_their_part() {
    let patch = bed(32, 100.0);
    let union = ball(0.03);
    let object = FreeObject::new(&union, 0.05, DVec3::ZERO).unwrap();
    let alone = on(&patch, &object, &at(0.0, 0.0, 0.05));
    // If all taxels are held down by a millimetre, the object rests lower, with the deflections that carry it.
    let held = vec![1e-3; patch.n_taxels()];
    let skins = [PlacedSkin {
        pushed: &held,
        ..PlacedSkin::new(&patch, Pose::IDENTITY)
    }];
    let lower = equilibrium(&object, &skins, &at(0.0, 0.0, 0.05));
    assert_eq!(lower.outcome, Outcome::AtRest);
    assert!(lower.imbalance < 1e-6);
    assert!(
        lower.pose.translation.z < alone.pose.translation.z - 0.3e-3,
        "{lower:?} {alone:?}"
    );
}

/// Returns whether a taxel is beside the widest part of a sphere. The energy jumps there, because an infinitesimal lateral motion of the sphere releases the
/// taxel or pushes it in.
fn stands_on_a_cliff(bed: &Patch, spheres: &SphereUnion, pose: &Pose) -> bool {
    const NEAR: f64 = 2e-4;
    let radius = bed.taxels().at(0).radius;
    spheres.spheres().iter().any(|sphere| {
        let center = pose.transform_point(sphere.center);
        let beside = |taxel: &DVec3| (center - *taxel).truncate().length();
        let is_at_edge = |taxel: &DVec3| (beside(taxel) - sphere.radius - radius).abs() < NEAR;
        center.z < NEAR && bed.layout().centers().iter().any(is_at_edge)
    })
}

/// Returns the energy of springs and height for a solid of spheres on a bed, joules; `None` if a taxel is pushed beyond its stop.
fn energy(bed: &Patch, (spheres, mass): (&SphereUnion, f64), pose: &Pose) -> Option<f64> {
    let Taxel {
        stiffness, stroke, ..
    } = *bed.taxels().at(0);
    let springs =
        needed(bed, spheres, pose).map(|d| (d <= stroke).then_some(0.5 * stiffness * d * d));
    let springs: Option<f64> = springs.sum();
    let height = pose.transform_point(spheres.center_of_mass()).z;
    Some(springs? + mass * G * height)
}

/// Asserts that none of 100 small motions lowers the energy by more than the accepted imbalance allows. Returns the number of motions tried, which is zero if a
/// stop carries load or a taxel is beside a sphere.
fn assert_lowest(
    bed: &Patch,
    (spheres, mass): (&SphereUnion, f64),
    pose: &Pose,
    case: u64,
) -> usize {
    let lowest = energy(bed, (spheres, mass), pose);
    let Some(lowest) = lowest.filter(|_| !stands_on_a_cliff(bed, spheres, pose)) else {
        return 0;
    };
    let mut rng = Seed::new(case).named("motions").rng();
    let mut random = || rng.gen_range(-1.0..1.0);
    let size = spheres.reach_from(DVec3::ZERO);
    let mut n_tried = 0;
    for _ in 0..100 {
        let step = 10f64.powf(-5.5 + random());
        let turn = DQuat::from_scaled_axis(step / size * DVec3::new(random(), random(), random()));
        let moved = Pose::new(
            turn * pose.rotation,
            pose.translation + step * DVec3::new(random(), random(), random()),
        );
        // Some motions would push a taxel beyond its stop.
        let Some(there) = energy(bed, (spheres, mass), &moved) else {
            continue;
        };
        n_tried += 1;
        let allowed = 4e-6 * mass * G * step + 1e-14 * (lowest.abs() + there.abs());
        assert!(
            there >= lowest - allowed,
            "case {case}: {step} m lowers {lowest} J by {}",
            lowest - there
        );
    }
    n_tried
}

#[test]
fn random_objects_settle_or_leave() {
    let tried: Vec<Option<usize>> = (0..150_u64)
        .into_par_iter()
        .map(|case| {
            let mut rng = Seed::new(case).named("free objects").rng();
            let size = 10f64.powf(rng.gen_range(-2.3..-1.3));
            let mut random = |a: f64, b: f64| rng.gen_range(a..b);
            let n_spheres = random(1.0, 40.0) as usize;
            let spheres = (0..n_spheres).map(|_| Sphere {
                center: size * DVec3::new(random(-1.0, 1.0), random(-1.0, 1.0), random(-1.0, 1.0)),
                radius: size * random(0.05, 0.6),
            });
            let union = SphereUnion::new(spheres.collect()).unwrap();
            let mass = 10f64.powf(random(-3.0, 1.0));
            let patch = bed(32, 10f64.powf(random(1.0, 4.0)));
            let object = FreeObject::new(&union, mass, union.center_of_mass()).unwrap();
            let turn = DQuat::from_xyzw(
                random(-1.0, 1.0),
                random(-1.0, 1.0),
                random(-1.0, 1.0),
                random(-1.0, 1.0),
            );
            let start = Pose::new(
                turn.normalize(),
                DVec3::new(random(-0.03, 0.03), random(-0.03, 0.03), 0.2),
            );
            let rest = on(&patch, &object, &start);
            assert!(rest.pose.translation.is_finite() && rest.pose.rotation.is_finite());
            match rest.outcome {
                Outcome::AtRest => {
                    assert!(rest.imbalance <= 1e-6, "case {case}: {rest:?}");
                    // Comparing every sphere with every taxel a hundred times is slow, so only some cases are tried.
                    let is_tried = case.is_multiple_of(5);
                    let tried = || assert_lowest(&patch, (&union, mass), &rest.pose, case);
                    Some(if is_tried { tried() } else { 0 })
                }
                Outcome::Escaped { direction } => {
                    assert!((direction.length() - 1.0).abs() < 1e-9);
                    None
                }
                Outcome::NotConverged => panic!("case {case}: {rest:?}"),
            }
        })
        .collect();
    let settled: Vec<usize> = tried.into_iter().flatten().collect();
    assert!((45..148).contains(&settled.len()), "{}", settled.len());
    // The other cases rest on stops, or have taxels beside a sphere.
    let n_tried: usize = settled.iter().sum();
    assert!(n_tried > 300, "{n_tried}");
}

#[test]
fn bad_input_is_named() {
    let union = ball(0.01);
    let nowhere = DVec3::new(f64::NAN, 0.0, 0.0);
    for (mass, center, gravity, place, said) in [
        (0.0, DVec3::ZERO, DOWN, DVec3::ZERO, "object mass"),
        (-1.0, DVec3::ZERO, DOWN, DVec3::ZERO, "object mass"),
        (f64::NAN, DVec3::ZERO, DOWN, DVec3::ZERO, "object mass"),
        (f64::INFINITY, DVec3::ZERO, DOWN, DVec3::ZERO, "object mass"),
        (1.0, nowhere, DOWN, DVec3::ZERO, "centre of mass"),
        (1.0, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, "gravity"),
        (1.0, DVec3::ZERO, DOWN, nowhere, "pose of object 1:"),
    ] {
        let start = Pose::from_translation(place);
        let object = FreeObject::new(&union, mass, center);
        let solved = object.and_then(|o| EquilibriumSolver::new().solve(&o, &[], gravity, &start));
        let error = solved.unwrap_err().to_string();
        assert!(error.starts_with(said), "{error}");
    }
}
