//! Laws of taxels with mass: closed forms, rest, energy, and the limit of explicit steps.

use crate::scenes;
use bubbletouch_sim::contact::equilibrium::{EquilibriumSolver, FreeObject, Outcome, PlacedSkin};
use bubbletouch_sim::dynamics::{
    Divergence, Drive, ImplicitEuler, Integrator, SemiImplicit, State, Steps, System, rest, run,
    skin_sim,
};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::Model;
use bubbletouch_sim::world::{Layout, Patch, Phase, Taxel, Taxels, VelocityPlan};
use glam::DVec3;

const RADIUS: f64 = 2e-3;
const BALL: f64 = 20e-3;
/// Distance between the centres of a ball and the taxel right below it at first contact.
const TOUCHING: f64 = RADIUS + BALL;

fn taxel(damping: f64) -> Taxel {
    Taxel {
        radius: RADIUS,
        stiffness: 100.0,
        damping,
        stroke: 5e-3,
    }
}

fn skin(n: usize, taxel: Taxel) -> Patch {
    scenes::skin(scenes::grid(n, n, 4e-3).layout().clone(), taxel)
}

/// Returns a skin whose taxels a ball meets all at the same time. The ball lies stably on it, although the equilibrium solver lets it move sideways.
fn bowl(n: usize, taxel: Taxel) -> Patch {
    let flat = skin(n, taxel);
    let raised = flat.layout().centers().iter().map(|center| {
        let across = center.length_squared();
        *center + (TOUCHING - (TOUCHING * TOUCHING - across).sqrt()) * DVec3::Z
    });
    let layout = Layout::new(raised.collect(), vec![DVec3::Z; n * n]).unwrap();
    scenes::skin(layout, taxel)
}

fn ball() -> Model {
    scenes::ball(BALL).into()
}

fn at(height: f64) -> Pose {
    Pose::from_translation(height * DVec3::Z)
}

fn free(mass: f64) -> Drive {
    Drive::Free {
        mass,
        gravity: 9.81,
        travel: 0.0,
    }
}

/// Returns an imposed motion of a ball that stays far above the skin.
fn far_away() -> Drive {
    Drive::Imposed(VelocityPlan::new(at(1.0), vec![]).unwrap())
}

fn system<'a>(patch: &'a Patch, ball: &'a Model, mass: f64, drive: Drive) -> System<'a> {
    System::new(patch, mass, ball, at(TOUCHING), drive, 10e-3).unwrap()
}

fn steps(dt: f64, n: usize) -> Steps<'static> {
    Steps {
        dt,
        n,
        frames: &[],
        energy_limit: f64::INFINITY,
    }
}

/// Returns a state at rest with one deflected taxel.
fn deflected(system: &System, deflection: f64) -> State {
    let mut state = State::start(system);
    state.deflection[0] = deflection;
    state
}

fn both(state: &State) -> [Box<dyn Integrator>; 2] {
    [
        Box::new(SemiImplicit::from_state(state.clone(), 1e4)),
        Box::new(ImplicitEuler::from_state(state.clone())),
    ]
}

/// Returns the error of an integrator: its deflection of the first taxel after `time` minus `exact`.
fn error_after(
    system: &System,
    start: &State,
    which: usize,
    time: f64,
    n: usize,
    exact: f64,
) -> f64 {
    let mut integrators = both(start);
    let integrator = integrators[which].as_mut();
    run(system, integrator, &steps(time / n as f64, n)).unwrap();
    (integrator.state(system).deflection[0] - exact).abs()
}

#[test]
fn free_relaxation_tends_to_the_closed_form_with_order_one() {
    let (m, c, time) = (1e-3, 0.3, 0.01);
    let (patch, ball) = (skin(1, taxel(c)), ball());
    // The ball never reaches the taxel.
    let system = System::new(&patch, m, &ball, at(1.0), far_away(), 1e-3).unwrap();
    let start = deflected(&system, 1e-3);
    let (decay, omega) = (c / (2.0 * m), (100.0 / m - (c / (2.0 * m)).powi(2)).sqrt());
    let swing = (omega * time).cos() + decay / omega * (omega * time).sin();
    let exact = 1e-3 * (-decay * time).exp() * swing;
    for which in [0, 1] {
        let error = |n| error_after(&system, &start, which, time, n, exact);
        let order = (error(1000) / error(2000)).log2();
        assert!((order - 1.0).abs() < 0.05, "{which}: {order}");
        assert!(error(2000) < 1e-2 * 1e-3, "{which}");
    }
}

#[test]
fn the_step_response_under_a_weight_tends_to_the_closed_form_with_order_one() {
    // Contact holds throughout: ball and taxel are one body of mass M + m on one spring, released at the spring's rest length.
    let (m, mass, c, time) = (1e-2, 0.02, 2.0, 0.02);
    let (patch, ball) = (skin(1, taxel(c)), ball());
    let system = system(&patch, &ball, m, free(mass));
    let both_masses = m + mass;
    let decay = c / (2.0 * both_masses);
    let omega = (100.0 / both_masses - decay * decay).sqrt();
    let swing = (omega * time).cos() + decay / omega * (omega * time).sin();
    let exact = mass * 9.81 / 100.0 * (1.0 - (-decay * time).exp() * swing);
    let start = State::start(&system);
    let error = |n| error_after(&system, &start, 1, time, n, exact);
    let order = (error(1000) / error(2000)).log2();
    assert!((order - 1.0).abs() < 0.05, "{order}");
    assert!(error(2000) < 1e-3 * exact);
    // A penalty method also has an error due to penetration, which decreases with the contact stiffness.
    let penalty = |stiffness| {
        let mut integrator = SemiImplicit::new(&system, stiffness);
        run(&system, &mut integrator, &steps(time / 20_000.0, 20_000)).unwrap();
        (integrator.state(&system).deflection[0] - exact).abs()
    };
    assert!(penalty(1e6) < 0.02 * exact && penalty(1e6) < 0.5 * penalty(1e4));
}

#[test]
fn a_ball_on_its_guide_comes_to_the_rest_of_the_quasi_static_balance() {
    // The damping is critical for the ball, so it comes to rest quickly.
    let (mass, n) = (0.02, 4);
    let c = 2.0 * f64::sqrt(100.0 * (mass / 16.0 + 1e-4));
    let (patch, ball) = (bowl(n, taxel(c)), ball());
    let system = system(&patch, &ball, 1e-4, free(mass));
    let found = rest(&system).unwrap();
    let object = FreeObject::new(ball.spheres().unwrap(), mass, DVec3::ZERO).unwrap();
    let skin = PlacedSkin::new(&patch, Pose::IDENTITY);
    let gravity = -9.81 * DVec3::Z;
    let mut balancer = EquilibriumSolver::new();
    let balance = balancer
        .solve(&object, &[skin], gravity, &at(TOUCHING))
        .unwrap();
    assert_eq!(balance.outcome, Outcome::AtRest);
    let travel = TOUCHING - balance.pose.translation.z;
    assert!(
        (travel - found.travel).abs() < 1e-9,
        "{travel} {}",
        found.travel
    );
    let mut implicit = ImplicitEuler::new(&system);
    run(&system, &mut implicit, &steps(1e-3, 3000)).unwrap();
    let state = implicit.state(&system);
    assert!((state.travel - travel).abs() < 1e-9);
    assert!((state.support() / (mass * 9.81) - 1.0).abs() < 1e-9);
    // With penalty contact the rest position is deeper by the penetration of each contact.
    let kappa = 1e5;
    let mut explicit = SemiImplicit::new(&system, kappa);
    run(&system, &mut explicit, &steps(1e-5, 200_000)).unwrap();
    let state = explicit.state(&system);
    let sunk = mass * 9.81 / 16.0 / kappa;
    assert!((state.travel - travel - sunk).abs() < 1e-3 * sunk);
}

#[test]
fn a_ball_too_heavy_for_the_springs_rests_on_the_stops_which_carry_what_they_do_not() {
    let mass = 10.0;
    let (patch, ball) = (skin(2, taxel(1.0)), ball());
    let system = system(&patch, &ball, 1e-4, free(mass));
    let found = rest(&system).unwrap();
    assert_eq!(found.travel, system.floor());
    assert!((found.stops - (mass * 9.81 - 4.0 * 100.0 * 5e-3)).abs() < 1e-9);
    for dt in [1e-4, 1e-2, 1.0] {
        let mut integrator = ImplicitEuler::new(&system);
        run(&system, &mut integrator, &steps(dt, 2000)).unwrap();
        let state = integrator.state(&system);
        assert_eq!(state.travel, system.floor());
        assert!((state.support() / (mass * 9.81) - 1.0).abs() < 1e-9);
        assert!(state.deflection.iter().all(|&d| d == 5e-3));
    }
}

#[test]
fn implicit_euler_never_gains_energy_however_long_the_step() {
    for (mass, m) in [(1e-3, 1e-2), (1.0, 1e-7), (1e3, 1e-4)] {
        for damping in [0.0, 0.1, 10.0] {
            let (patch, ball) = (skin(4, taxel(damping)), ball());
            let system = system(&patch, &ball, m, free(mass));
            for dt in [1e-6, 1e-4, 1e-2, 1.0, 100.0] {
                let mut start = State::start(&system);
                // The object has an initial speed, and taxels oscillate.
                start.speed = 1.0;
                start.deflection[0] = 2e-3;
                let mut before = start.energy(&system);
                let mut integrator = ImplicitEuler::from_state(start);
                for _ in 0..300 {
                    integrator.step(&system, dt);
                    let after = integrator.state(&system).energy(&system);
                    let scale = before.abs().max(after.abs()).max(mass * 0.5);
                    assert!(
                        after <= before + 1e-12 * scale,
                        "{mass} {m} {dt}: {before} {after}"
                    );
                    before = after;
                }
            }
        }
    }
}

#[test]
fn explicit_steps_diverge_beyond_their_limit_and_not_before() {
    let (patch, ball) = (skin(1, taxel(0.0)), ball());
    for m in [1e-7, 1e-3, 1e-2] {
        let system = System::new(&patch, m, &ball, at(1.0), far_away(), 1e-3).unwrap();
        let limit = 2.0 * (m / 100.0_f64).sqrt();
        let diverges = |dt: f64| {
            let start = deflected(&system, 1e-6);
            let limit = 1e6 * start.energy(&system);
            let mut integrator = SemiImplicit::from_state(start, 0.0);
            let steps = Steps {
                energy_limit: limit,
                ..steps(dt, 20_000)
            };
            run(&system, &mut integrator, &steps)
                .unwrap()
                .divergence
                .is_some()
        };
        assert!(!diverges(0.999 * limit), "{m}");
        assert!(diverges(1.001 * limit), "{m}");
    }
}

#[test]
fn an_imposed_ball_holds_taxels_where_it_is_and_a_run_says_why_it_stopped() {
    let (patch, ball) = (skin(4, taxel(0.2)), ball());
    let down = Phase {
        duration: 0.02,
        linear: -0.1 * DVec3::Z,
        angular: DVec3::ZERO,
    };
    let plan = VelocityPlan::new(at(TOUCHING), vec![down]).unwrap();
    let system = system(&patch, &ball, skin_sim::TAXEL_MASS, Drive::Imposed(plan));
    let frames = [50, 1000];
    let steps = Steps {
        frames: &frames,
        ..steps(skin_sim::DT, 1000)
    };
    let recorded = run(&system, &mut ImplicitEuler::new(&system), &steps).unwrap();
    assert_eq!(recorded.recording.deflection.dim(), (2, 16));
    assert!((recorded.travel[1] - 2e-3).abs() < 1e-15);
    for (taxel, start) in system.starts().iter().enumerate() {
        let held = (2e-3 - start).max(0.0);
        assert!((recorded.recording.deflection[(1, taxel)] - held).abs() < 1e-9);
        assert!((recorded.recording.force[(1, taxel)] - 100.0 * held).abs() < 1e-6);
    }
    let mut penalty = SemiImplicit::new(&system, 1e7);
    let limited = Steps {
        energy_limit: 1.0,
        ..steps
    };
    let broken = run(&system, &mut penalty, &limited).unwrap();
    assert_eq!(broken.divergence, Some(Divergence::EnergyGrowth));
    assert!(broken.n_steps < 1000 && broken.travel.len() < 2);
}

#[test]
fn what_cannot_be_simulated_is_refused_by_its_name() {
    let (patch, ball) = (skin(1, taxel(0.0)), ball());
    let refused = |mass, drive, reach| {
        let made = System::new(&patch, mass, &ball, at(1.0), drive, reach);
        made.unwrap_err().to_string()
    };
    assert!(refused(0.0, free(1.0), 1.0).contains("taxel mass: 0 kg"));
    assert!(refused(1.0, free(f64::NAN), 1.0).contains("object mass: NaN kg"));
    assert!(refused(1.0, free(1.0), -1.0).contains("reach"));
    let tilted = Layout::new(vec![DVec3::ZERO], vec![DVec3::X]).unwrap();
    let tilted = Patch::new("side", tilted, Taxels::Equal(taxel(0.0))).unwrap();
    let error = System::new(&tilted, 1.0, &ball, at(1.0), free(1.0), 1.0).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("skin patch side, taxel 1: axis")
    );
    let system = system(&patch, &ball, 1.0, free(1.0));
    let mut integrator = ImplicitEuler::new(&system);
    for (dt, frames, said) in [(0.0, &[1][..], "time step"), (1.0, &[2, 2][..], "frames")] {
        let steps = Steps {
            frames,
            ..steps(dt, 3)
        };
        let error = run(&system, &mut integrator, &steps).unwrap_err();
        assert!(error.to_string().starts_with(said), "{error}");
    }
}

#[cfg(feature = "rapier")]
#[test]
fn taxels_as_bodies_in_rapier_come_to_the_same_rest_where_masses_are_alike() {
    use bubbletouch_sim::dynamics::{RapierSettings, RapierWorld};
    let (mass, m) = (0.04, 1e-3);
    let c = 2.0 * f64::sqrt(100.0 * (mass / 4.0 + m));
    let (patch, ball) = (skin(2, taxel(c)), ball());
    let system = system(&patch, &ball, m, free(mass));
    let found = rest(&system).unwrap();
    let mut world = RapierWorld::new(&system, RapierSettings::tuned(&system)).unwrap();
    run(&system, &mut world, &steps(1e-3, 1000)).unwrap();
    let state = world.state(&system);
    assert!(
        (state.travel / found.travel - 1.0).abs() < 1e-3,
        "{}",
        state.travel
    );
    assert!((state.support() / (mass * 9.81) - 1.0).abs() < 1e-3);
}

/// Masses of a stack of balls, from below, kg.
const STACK: [f64; 4] = [0.02, 0.05, 0.01, 0.03];

#[test]
fn a_stack_that_sinks_sinks_as_one_object_of_its_mass() {
    let (patch, ball) = (bowl(6, taxel(2.0)), ball());
    let stack = system(&patch, &ball, 1e-3, free(STACK[0]));
    let stack = stack.stacked(&STACK[1..]).unwrap();
    let all: f64 = STACK.iter().sum();
    let one = system(&patch, &ball, 1e-3, free(all));
    let (mut of_stack, mut of_one) = (ImplicitEuler::new(&stack), ImplicitEuler::new(&one));
    for step in 0..300 {
        of_stack.step(&stack, 1e-3);
        of_one.step(&one, 1e-3);
        let (found, wanted) = (of_stack.state(&stack), of_one.state(&one));
        assert!((found.travel - wanted.travel).abs() < 1e-12, "{step}");
        assert!((found.support() - wanted.support()).abs() < 1e-9, "{step}");
        assert!(
            found
                .riders
                .iter()
                .all(|rider| rider.travel == found.travel)
        );
        let apart = found.energy(&stack) - wanted.energy(&one);
        assert!(apart.abs() < 1e-12, "{step}: {apart}");
    }
    let end = rest(&stack).unwrap();
    assert_eq!(end, rest(&one).unwrap());
    assert!((of_stack.state(&stack).travel - end.travel).abs() < 1e-8);
}

#[test]
fn a_stack_comes_to_rest_with_its_whole_weight_on_the_skin_stops_or_none() {
    for heavier in [1.0, 100.0] {
        let (patch, ball) = (bowl(6, taxel(2.0)), ball());
        let masses = STACK.map(|mass| heavier * mass);
        let stack = system(&patch, &ball, 1e-3, free(masses[0]));
        let stack = stack.stacked(&masses[1..]).unwrap();
        let end = rest(&stack).unwrap();
        let weight = 9.81 * masses.iter().sum::<f64>();
        assert_eq!(end.stops > 0.0, heavier > 1.0);
        let implicit: Box<dyn Integrator> = Box::new(ImplicitEuler::new(&stack));
        let mut integrators = vec![(implicit, 1e-3, 1e-9)];
        if end.stops == 0.0 {
            // On stops nothing damps balls with penalty contact, so they oscillate forever.
            let penalty = SemiImplicit::new(&stack, 1e6);
            integrators.push((Box::new(penalty), 2e-5, 3e-3));
        }
        for (mut integrator, dt, tolerance) in integrators {
            let n = (2.0 / dt) as usize;
            let ran = run(&stack, integrator.as_mut(), &steps(dt, n)).unwrap();
            assert_eq!(ran.divergence, None);
            let state = integrator.state(&stack);
            let off = (state.travel - end.travel).abs();
            assert!(off < tolerance * end.travel + 1e-8, "{off}");
            let imbalance = (state.support() / weight - 1.0).abs();
            assert!(
                imbalance < tolerance.max(1e-6),
                "{heavier}, {dt}: {imbalance}"
            );
        }
    }
}

#[test]
fn a_stack_with_gaps_is_thrown_up_and_falls_back_with_forces_that_only_push() {
    const DT: f64 = 1e-3;
    let (patch, ball) = (bowl(6, taxel(0.05)), ball());
    let stack = system(&patch, &ball, 1e-3, free(STACK[0]));
    let stack = stack.stacked(&STACK[1..]).unwrap();
    let mut start = State::start(&stack);
    start.travel = 4e-3;
    start.deflection.fill(4e-3);
    for (number, rider) in start.riders.iter_mut().enumerate() {
        // Some riders start without contact to the ball below.
        rider.travel = 4e-3 - 2e-3 * (number / 2) as f64;
    }
    let mut integrator = ImplicitEuler::from_state(start.clone());
    let (mut before, mut widest) = (start.clone(), 0.0_f64);
    let mut energy = before.energy(&stack);
    for step in 0..3000 {
        integrator.step(&stack, DT);
        let now = integrator.state(&stack).clone();
        let bodies = |state: &State| -> Vec<(f64, f64)> {
            let riders = state.riders.iter().map(|rider| (rider.travel, rider.speed));
            [(state.travel, state.speed)]
                .into_iter()
                .chain(riders)
                .collect()
        };
        let (old, new) = (bodies(&before), bodies(&now));
        // Force that each ball needs from the ball below, summed from above.
        let mut carried = 0.0;
        for number in (1..STACK.len()).rev() {
            carried += STACK[number] * (9.81 - (new[number].1 - old[number].1) / DT);
            let gap = new[number - 1].0 - new[number].0;
            assert!(gap >= -1e-15, "{step}, {number}: {gap}");
            assert!(carried > -1e-9, "{step}, {number}: {carried}");
            assert!(
                gap < 1e-12 || carried.abs() < 1e-9,
                "{step}, {number}: {gap} {carried}"
            );
            widest = widest.max(gap);
        }
        carried += STACK[0] * (9.81 - (new[0].1 - old[0].1) / DT);
        assert!((carried - now.support()).abs() < 1e-8, "{step}");
        let next = now.energy(&stack);
        assert!(next <= energy + 1e-12, "{step}: {next} J after {energy} J");
        (before, energy) = (now, next);
    }
    assert!(widest > 1e-3, "{widest}");
    assert!((before.travel - rest(&stack).unwrap().travel).abs() < 1e-6);
    assert!(
        before
            .riders
            .iter()
            .all(|rider| (rider.travel - before.travel).abs() < 1e-6)
    );
}

#[test]
fn balls_are_stacked_on_one_free_sphere_and_have_a_mass() {
    let (patch, ball) = (bowl(2, taxel(0.0)), ball());
    let free = system(&patch, &ball, 1e-3, free(1.0));
    let error = free.stacked(&[1.0, -1.0]).unwrap_err().to_string();
    assert!(error.contains("mass of a stacked ball: -1 kg"), "{error}");
    let imposed = System::new(&patch, 1e-3, &ball, at(1.0), far_away(), 1e-3).unwrap();
    let error = imposed.stacked(&[1.0]).unwrap_err().to_string();
    assert!(error.contains("one sphere that is free"), "{error}");
}
