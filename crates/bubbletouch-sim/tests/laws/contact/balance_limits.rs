//! Limits of the balance of free objects. Each case has the behaviour that the guide's page on limits states.

use crate::scenes::{TAXEL, ball, bed, direction, one_taxel, rng, skin, union};
use bubbletouch_sim::contact::equilibrium::{
    Equilibrium, EquilibriumSolver, FreeObject, Outcome, PlacedSkin,
};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Sphere, SphereUnion};
use bubbletouch_sim::world::{Patch, Taxel, Taxels};
use glam::{DQuat, DVec3};
use rand::Rng;

const G: f64 = 9.81;
const DOWN: DVec3 = DVec3::new(0.0, 0.0, -G);

fn settle_on(skin: &Patch, at: Pose, object: &FreeObject, start: &Pose) -> Equilibrium {
    let skins = [PlacedSkin::new(skin, at)];
    EquilibriumSolver::new()
        .solve(object, &skins, DOWN, start)
        .unwrap()
}

fn equilibrium(skin: &Patch, object: &FreeObject, start: &Pose) -> Equilibrium {
    settle_on(skin, Pose::IDENTITY, object, start)
}

fn height(z: f64) -> Pose {
    Pose::from_translation(DVec3::new(0.0, 0.0, z))
}

/// Returns the deflection that spheres need of each taxel of a flat skin at the origin, metres, not limited to the stroke; 0 if no sphere touches the taxel.
/// Spheres whose centres are behind the substrate do not push.
pub(super) fn needed(
    skin: &Patch,
    spheres: &SphereUnion,
    pose: &Pose,
) -> impl Iterator<Item = f64> {
    let placed = spheres.moved(pose).spheres().to_vec();
    let centers = skin.layout().centers().iter().enumerate();
    centers.map(move |(number, &taxel)| {
        let own = skin.taxels().at(number);
        let of_sphere = |sphere: &Sphere| {
            let from = sphere.center - taxel;
            let reach = sphere.radius + own.radius;
            let left = reach * reach - from.truncate().length_squared();
            match left > 0.0 && sphere.center.z >= own.substrate() {
                true => left.sqrt() - from.z,
                false => 0.0,
            }
        };
        placed.iter().map(of_sphere).fold(0.0, f64::max)
    })
}

/// Returns the height at which the springs carry a ball of a weight (newtons) above a place, computed by bisection from the formula.
pub(super) fn height_of_formula(
    skin: &Patch,
    ball: &SphereUnion,
    place: DVec3,
    weight: f64,
) -> f64 {
    let (mut low, mut high) = (0.015, 0.04);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        let pose = Pose::from_translation(place.with_z(middle));
        match lift(skin, ball, &pose) > weight {
            true => low = middle,
            false => high = middle,
        }
    }
    low
}

/// Returns the force that all springs carry, newtons.
fn lift(skin: &Patch, spheres: &SphereUnion, pose: &Pose) -> f64 {
    let needed = needed(skin, spheres, pose).enumerate();
    needed
        .map(|(number, needed)| skin.taxels().at(number).stiffness * needed)
        .sum()
}

/// Returns the fault of an equilibrium that should be at rest; `None` if there is none.
fn fault(rest: &Equilibrium, weight: f64) -> Option<String> {
    let is_balanced = rest.imbalance <= 1e-6 && (rest.force.z / weight - 1.0).abs() <= 1e-6;
    let is_right = rest.outcome == Outcome::AtRest && is_balanced;
    (!is_right).then(|| format!("{rest:?}"))
}

fn assert_rests(rest: &Equilibrium, weight: f64, case: &str) {
    if let Some(fault) = fault(rest, weight) {
        panic!("{case}: {fault}");
    }
}

fn assert_none(faults: &[String]) {
    assert!(
        faults.is_empty(),
        "{} faults:\n{}",
        faults.len(),
        faults.join("\n")
    );
}

#[test]
fn a_million_metres_from_the_origin_objects_rest_as_at_it() {
    let places = [-1.0, 0.0, 1.0].map(|x| DVec3::new(0.01 * x, 0.004 * x * x, 0.0));
    let object = union(places, 0.012);
    for stiffness in [1.0, 1e2, 1e4, 1e6, 1e8] {
        let skin = bed(32, stiffness);
        for mass in [1e-3, 1.0] {
            let body = FreeObject::new(&object, mass, DVec3::new(0.0, 1.5e-3, 0.0)).unwrap();
            let here = equilibrium(&skin, &body, &height(0.0625));
            let far = DVec3::new(1e6, -1e6, 1e6);
            let there = settle_on(
                &skin,
                Pose::from_translation(far),
                &body,
                &Pose::from_translation(far + DVec3::new(0.0, 0.0, 0.0625)),
            );
            let case = format!("{mass} kg on {stiffness} N/m");
            assert_rests(&there, mass * G, &case);
            assert_eq!(there.outcome, here.outcome, "{case}");
            // A nanometre is the resolution of coordinates of a million metres.
            let apart = (there.pose.translation - far).distance(here.pose.translation);
            assert!(apart < 1e-9, "{case}: {apart} m");
            assert_eq!(there.force, here.force, "{case}");
        }
    }
}

/// Returns whether the solver reports no convergence because the spring is too stiff. In this case the last bit of the position, relative to the start, changes
/// the spring force by more than the accepted imbalance.
fn is_beyond_last_bits(rest: &Equilibrium, stiffness: f64, size: f64, weight: f64) -> bool {
    let place = size + (0.05 - rest.pose.translation.z);
    let last_bit = f64::EPSILON * place;
    rest.outcome == Outcome::NotConverged && stiffness * last_bit > 1e-6 * weight
}

#[test]
fn neighbours_a_trillion_times_as_stiff_share_a_load_as_they_must() {
    let (mut faults, mut n_unsettled) = (Vec::new(), 0);
    for case in 0..40 {
        let mut rng = rng("stiffness ratios", case);
        let n = 24;
        let grid = bed(n, 1.0);
        let soft = 10f64.powf(rng.gen_range(-4.0..-2.0));
        let taxels = (0..n * n).map(|number| Taxel {
            stiffness: if (number / n + number % n) % 2 == 0 {
                soft
            } else {
                1e12 * soft
            },
            ..TAXEL
        });
        let skin = skin(grid.layout().clone(), Taxels::Each(taxels.collect()));
        let radius = rng.gen_range(4e-3..2e-2);
        let object = union(
            (0..8).map(|_| 8e-3 * direction(&mut rng).with_z(0.0)),
            radius,
        );
        let mass = 10f64.powf(rng.gen_range(-3.0..1.0));
        let body = FreeObject::new(&object, mass, DVec3::ZERO).unwrap();
        let rest = equilibrium(&skin, &body, &height(0.05));
        let about = format!("case {case}, {mass} kg on {soft} N/m and {:e}", 1e12 * soft);
        let size = object.reach_from(DVec3::ZERO);
        if is_beyond_last_bits(&rest, 1e12 * soft, size, mass * G) {
            n_unsettled += 1;
            continue;
        }
        faults.extend(fault(&rest, mass * G).map(|fault| format!("{about}: {fault}")));
    }
    assert_none(&faults);
    assert!(n_unsettled <= 2, "{n_unsettled}");
}

#[test]
fn a_ball_rests_on_a_pattern_of_springs_at_the_height_of_the_formula() {
    // By symmetry a ball over the middle of four stiff taxels stays there.
    let mut n_unsettled = 0;
    for soft in [1e-3, 1.0] {
        let n = 16;
        let is_middle = |k: usize| k == 7 || k == 8;
        let stiffness = |number: usize| match is_middle(number / n) && is_middle(number % n) {
            true => 1e12 * soft,
            false => soft,
        };
        let taxels = (0..n * n).map(|number| Taxel {
            stiffness: stiffness(number),
            ..TAXEL
        });
        let skin = skin(bed(n, 1.0).layout().clone(), Taxels::Each(taxels.collect()));
        let ball = ball(0.02);
        for mass in [1e-3, 1.0, 1e3] {
            let body = FreeObject::new(&ball, mass, DVec3::ZERO).unwrap();
            let rest = equilibrium(&skin, &body, &height(0.05));
            let case = format!("{mass} kg on {soft} N/m");
            if is_beyond_last_bits(&rest, 1e12 * soft, 0.02, mass * G) {
                n_unsettled += 1;
                continue;
            }
            assert_rests(&rest, mass * G, &case);
            let low = height_of_formula(&skin, &ball, DVec3::ZERO, mass * G);
            let is_there = (rest.pose.translation.z - low).abs() < 1e-12;
            assert!(is_there, "{rest:?}: {low}");
            assert!(rest.pose.translation.truncate().length() < 1e-9, "{rest:?}");
        }
    }
    assert!(n_unsettled <= 1, "{n_unsettled}");
}

#[test]
fn what_balances_on_an_edge_or_a_point_does_not_stay_there() {
    let skin = bed(48, 200.0);
    // Objects: a tile of spheres, 20 × 20 × 2 mm, and a rod of 30 mm, with the heights of their middles when they lie.
    let square = (0..11).flat_map(|i| (0..11).map(move |j| (i, j)));
    let tile = square.map(|(i, j)| 2e-3 * DVec3::new(f64::from(i) - 5.0, f64::from(j) - 5.0, 0.0));
    let tile = union(tile, 2e-3);
    let rod = union(
        (0..16).map(|k| 2e-3 * DVec3::new(f64::from(k) - 7.5, 0.0, 0.0)),
        2e-3,
    );
    for (object, name) in [(&tile, "tile"), (&rod, "rod")] {
        let body = FreeObject::new(object, 0.01, DVec3::ZERO).unwrap();
        for lean in [0.0, 1e-12, -1e-6, 1e-3] {
            for turn in [0.0, 0.3] {
                // The object starts on its edge or end, exactly upright except for the lean.
                let upright = DQuat::from_rotation_z(turn)
                    * DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2 + lean);
                let start = Pose::new(upright, DVec3::new(0.0, 0.0, 0.02));
                let rest = equilibrium(&skin, &body, &start);
                let case = format!("{name}, {lean} off the vertical, turned by {turn}");
                assert_rests(&rest, 0.01 * G, &case);
                let flat = match name {
                    "tile" => rest.pose.rotation * DVec3::Z,
                    _ => (rest.pose.rotation * DVec3::X).cross(DVec3::Z),
                };
                let is_lying = match name {
                    "tile" => flat.z.abs() > 0.99,
                    _ => flat.length() > 0.99,
                };
                assert!(is_lying, "{case}: {rest:?}");
            }
        }
    }
}

#[test]
fn a_thin_sheet_that_falls_from_any_height_is_caught() {
    let mut faults = Vec::new();
    let skin = bed(32, 100.0);
    for case in 0..60 {
        let mut rng = rng("sheets", case);
        let thickness = 10f64.powf(rng.gen_range(-5.0..-3.0));
        let square = (0..21).flat_map(|i| (0..21).map(move |j| (i, j)));
        let places =
            square.map(|(i, j)| 1e-3 * DVec3::new(f64::from(i) - 10.0, f64::from(j) - 10.0, 0.0));
        let sheet = union(places, 0.5 * thickness);
        let mass = 10f64.powf(rng.gen_range(-4.0..-1.0));
        let body = FreeObject::new(&sheet, mass, DVec3::ZERO).unwrap();
        let above = 10f64.powf(rng.gen_range(-1.5..3.0));
        let turn = DQuat::from_rotation_z(rng.gen_range(0.0..6.0))
            * DQuat::from_rotation_x(rng.gen_range(-0.3..0.3));
        let place = DVec3::new(
            rng.gen_range(-5e-3..5e-3),
            rng.gen_range(-5e-3..5e-3),
            above,
        );
        let rest = equilibrium(&skin, &body, &Pose::new(turn, place));
        let about = format!("case {case}: {thickness} m thick, {mass} kg, from {above} m");
        faults.extend(fault(&rest, mass * G).map(|fault| format!("{about}: {fault}")));
        let middle = rest.pose.translation.z;
        assert!(
            middle > -TAXEL.stroke && middle < 2.0 * TAXEL.radius,
            "{about}: {rest:?}"
        );
    }
    assert_none(&faults);
}

#[test]
fn stops_carry_what_saturated_springs_do_not() {
    // A flat foot on all 12 × 12 taxels, whose springs carry at most a hundredth of the weight.
    let n = 12;
    let skin = bed(n, 10.0);
    let springs = (n * n) as f64 * 10.0 * TAXEL.stroke;
    let foot = union(skin.layout().centers().iter().copied(), 3e-3);
    for mass in [100.0, 1e4, 1e6] {
        for off in [0.0, 3e-3] {
            let body = FreeObject::new(&foot, mass, DVec3::new(off, -0.5 * off, 0.01)).unwrap();
            let rest = equilibrium(&skin, &body, &height(0.02));
            let case = format!("{mass} kg, {off} m off the middle");
            assert_rests(&rest, mass * G, &case);
            assert!(rest.force.z > 50.0 * springs);
            assert!(rest.n_saturated >= 3, "{case}: {rest:?}");
            // The stops are rigid, so no taxel is pressed beyond its stroke.
            let most = needed(&skin, &foot, &rest.pose).fold(0.0, f64::max);
            assert!((most - TAXEL.stroke).abs() < 1e-8, "{case}: {most}");
        }
    }
}

#[test]
fn a_taxel_exactly_between_three_spheres_carries_what_hangs_on_them() {
    let skin = one_taxel();
    let (radius, beside) = (5e-3, 4e-3);
    let places = [0.0, 2.0, 4.0].map(|third: f64| {
        let turn = DQuat::from_rotation_z(third * std::f64::consts::FRAC_PI_3);
        turn * DVec3::new(beside, 0.0, 0.0)
    });
    let mobile = union(places, radius);
    let reach: f64 = radius + TAXEL.radius;
    for mass in [1e-4, 1e-3, 1e-2, 0.04] {
        let body = FreeObject::new(&mobile, mass, DVec3::new(0.0, 0.0, -0.05)).unwrap();
        for (x, y) in [(0.0, 0.0), (3e-4, -2e-4)] {
            let start = Pose::from_translation(DVec3::new(x, y, 0.01));
            let rest = equilibrium(&skin, &body, &start);
            let case = format!("{mass} kg from {x}, {y}");
            assert_rests(&rest, mass * G, &case);
            let deflection = mass * G / TAXEL.stiffness;
            let exact = (reach * reach - beside * beside).sqrt() - deflection;
            assert!(
                (rest.pose.translation.z - exact).abs() < 1e-8,
                "{case}: {rest:?}"
            );
            assert!(
                rest.pose.translation.truncate().length() < 1e-7,
                "{case}: {rest:?}"
            );
        }
    }
}

#[test]
fn what_starts_inside_the_skin_comes_up_and_what_starts_behind_it_falls() {
    let skin = bed(32, 100.0);
    let ball = ball(0.02);
    let body = FreeObject::new(&ball, 0.05, DVec3::ZERO).unwrap();
    let above = equilibrium(&skin, &body, &height(0.05));
    // The sum of radii S is 21 mm, and the substrate is 6 mm behind the skin.
    for start in [0.02, 0.01, 0.0, -0.004, -0.0061, -0.012] {
        let rest = equilibrium(&skin, &body, &height(start));
        assert_rests(&rest, 0.05 * G, &format!("from {start} m"));
        let apart = (rest.pose.translation.z - above.pose.translation.z).abs();
        assert!(apart < 1e-6, "from {start} m: {rest:?}");
    }
    for start in [-0.0271, -0.03, -10.0] {
        let rest = equilibrium(&skin, &body, &height(start));
        let is_gone = matches!(rest.outcome, Outcome::Escaped { .. });
        assert!(is_gone, "from {start} m: {rest:?}");
    }
}

#[test]
fn balls_of_all_sizes_rest_at_the_height_of_the_formula_or_fall_between_the_taxels() {
    let mut faults = Vec::new();
    let skin = bed(16, 100.0);
    for (exponent, mass) in (-6..=0)
        .flat_map(|e| [1e-4, 1e-2, 1.0].map(|mass| (e, mass)))
        .chain([(2, 1e-2), (3, 1e-4)])
    {
        let radius = 10f64.powi(exponent);
        let ball = ball(radius);
        let body = FreeObject::new(&ball, mass, DVec3::ZERO).unwrap();
        let rest = equilibrium(&skin, &body, &height(radius + 0.01));
        let case = format!("{radius} m, {mass} kg");
        // The gaps between taxels are (√2 − 1) mm wide, so smaller balls fall through.
        if radius < 0.4e-3 {
            let is_gone = matches!(rest.outcome, Outcome::Escaped { .. });
            assert!(is_gone, "{case}: {rest:?}");
            continue;
        }
        // The ball is much larger than the bed and rolls off; the step limit may not suffice for this distance.
        if radius > 0.5 && rest.outcome != Outcome::AtRest {
            continue;
        }
        faults.extend(fault(&rest, mass * G).map(|fault| format!("{case}: {fault}")));
        if rest.n_saturated == 0 && rest.outcome == Outcome::AtRest {
            let error = lift(&skin, &ball, &rest.pose) / (mass * G) - 1.0;
            // Coordinates of a kilometre have a resolution of 1e-13 m.
            let known = 1e-6 + 256.0 * 100.0 * 4.0 * f64::EPSILON * radius / (mass * G);
            assert!(error.abs() < known, "{case}: {error}");
        }
    }
    assert_none(&faults);
}
