//! Simulation and evaluation of one configuration: a scene simulated by a method.

use crate::contact::equilibrium::{
    EquilibriumSolver, FreeObject, Ground, Outcome as EquilibriumOutcome, PlacedSkin,
};
use crate::contact::{DamperState, Press, Until, Workspace, spring_load};
use crate::dynamics::{
    Divergence, Drive, ImplicitEuler, Integrator, SemiImplicit, Steps, System, run,
};
use crate::studies::prelude::*;
use crate::studies::shared_steps::median_s;
use crate::studies::stability::rows::*;
use crate::studies::stability::scene::{ConfigurationScene, GRAVITY};
use crate::studies::stability::spec::*;
use crate::world::VelocityPlan;
use glam::DVec3;
use std::slice::from_ref;
use std::time::Instant;

/// Result of a simulation method at the time of evaluation.
#[derive(Default)]
struct Answer {
    /// Kind of failure of the simulation; `None` if it succeeded. After a failure, all other values are zero or empty.
    broken: Option<Outcome>,
    /// Relative error of the total contact force, |Σ f − expected| / expected, where f is the force of a taxel.
    force_imbalance: f64,
    /// Deflections of all taxels at the time of evaluation, metres, shape (n_taxels,).
    deflection: Vec<f64>,
    /// Sum of |δ| of all taxels after the ball has been lifted again, metres, where δ is the deflection; 0 if the ball is not lifted.
    left_over: f64,
    /// Number of time steps; 0 if the method does not step through time.
    n_steps: usize,
}

/// Computing time of a simulation, seconds. Shorter simulations are repeated, and their median time is reported. In a single short run, other load of the machine would
/// dominate.
const SHORT: f64 = 5e-3;
/// Number of repetitions of a short simulation, from which its computing time is determined.
const N_REPEATS: usize = 9;

/// Simulates and evaluates a configuration, given the taxel parameters without a damper.
pub(super) fn measure(
    configuration: &StabilityConfiguration,
    undamped: Taxel,
) -> Result<(StabilityScore, StabilityTime)> {
    let scene = ConfigurationScene::new(configuration, undamped)?;
    let tries = match configuration.method {
        ContactMethod::SemiImplicit => contact_stiffnesses(&scene)?.map(Some).to_vec(),
        _ => vec![None],
    };
    let tried = tries.into_iter().map(|contact_stiffness| {
        let again = || simulate(&scene, contact_stiffness);
        let start = Instant::now();
        let answer = again()?;
        let once_s = start.elapsed().as_secs_f64();
        let wall_s = match once_s < SHORT {
            true => median_s(0..N_REPEATS, |_| drop(again())),
            false => once_s,
        };
        let score = StabilityScore {
            contact_stiffness_n_per_m: contact_stiffness,
            ..judge(&scene, &answer)
        };
        let per_simulated_s = score.simulated_s.map(|seconds| wall_s / seconds);
        let time = StabilityTime {
            wall_s,
            per_simulated_s,
        };
        Ok((score, time))
    });
    let tried = tried.collect::<Result<Vec<_>>>()?.into_iter();
    let rank = |score: &StabilityScore| {
        let error = score.deflection_error.unwrap_or(f64::INFINITY);
        (score.outcome, error)
    };
    let best = tried.reduce(|kept, next| match rank(&next.0) < rank(&kept.0) {
        true => next,
        false => kept,
    });
    Ok(best.expect("at least one try"))
}

/// Contact stiffness that the simulation uses, divided by the stiffness that just meets the tolerance. Penetration reduces the deflection of every taxel.
const SAFETY: f64 = 4.0;

/// Returns two contact stiffnesses to test, N/m: the lowest that meets the tolerance, and the highest for which the time step is stable.
fn contact_stiffnesses(scene: &ConfigurationScene) -> Result<[f64; 2]> {
    let (taxel, truth) = (&scene.test_bed.taxel, &scene.truth);
    let deepest = truth.deflection.iter().copied().fold(0.0, f64::max);
    let n_at_least = |least: f64| truth.deflection.iter().filter(|d| **d >= least).count();
    // The taxels with the largest deflection share the load of the stops.
    let of_stops = truth.stops / n_at_least(deepest * (1.0 - 1e-9)) as f64;
    let heaviest = taxel.stiffness * deepest + of_stops;
    let needed = taxel.stiffness.max(heaviest / taxel.stroke);
    let exact = SAFETY * needed / TOLERANCE;
    let n_touched = n_at_least(f64::MIN_POSITIVE);
    let dt = scene.test_bed.configuration.dt_s;
    let stable = SemiImplicit::stiffest(&scene.system()?, dt, n_touched);
    Ok([exact, stable])
}

fn simulate(scene: &ConfigurationScene, contact_stiffness: Option<f64>) -> Result<Answer> {
    let configuration = scene.test_bed.configuration;
    if configuration.method == ContactMethod::QuasiStatic {
        return match (configuration.scene, &scene.drive) {
            (_, Drive::Imposed(plan)) => press_and_release(scene, plan),
            (StabilityScene::Plunger, _) => press_to_weight(scene),
            (_, Drive::Free { mass, .. }) => put_to_rest(scene, *mass),
        };
    }
    let system = scene.system()?;
    let mut integrator = integrator(configuration, &system, contact_stiffness)?;
    let frames = scene.frames();
    let steps = Steps {
        dt: configuration.dt_s,
        n: frames[frames.len() - 1],
        frames: &frames,
        energy_limit: scene.energy_limit,
    };
    let recorded = run(&system, integrator.as_mut(), &steps)?;
    let n_steps = recorded.n_steps;
    if let Some(divergence) = recorded.divergence {
        let broken = Some(match divergence {
            Divergence::NotFinite => Outcome::NotFinite,
            Divergence::EnergyGrowth => Outcome::EnergyGrowth,
        });
        return Ok(Answer {
            broken,
            n_steps,
            ..Answer::default()
        });
    }
    let felt = &recorded.recording;
    let released = felt.deflection.rows().into_iter().nth(1);
    Ok(Answer {
        force_imbalance: (felt.force.row(0).sum() / scene.force - 1.0).abs(),
        deflection: felt.deflection.row(0).to_vec(),
        left_over: released.map_or(0.0, |row| row.iter().map(|d| d.abs()).sum()),
        n_steps,
        broken: None,
    })
}

fn integrator(
    configuration: &StabilityConfiguration,
    system: &System,
    contact_stiffness: Option<f64>,
) -> Result<Box<dyn Integrator>> {
    match (configuration.method, contact_stiffness) {
        (ContactMethod::SemiImplicit, Some(stiffness)) => {
            Ok(Box::new(SemiImplicit::new(system, stiffness)))
        }
        #[cfg(feature = "rapier")]
        (method, _) if method.is_engine() => {
            use crate::dynamics::{RapierSettings, RapierWorld};
            // The plan sets the number of iterations for every engine.
            let n = configuration.solver_iterations.unwrap_or(1);
            let settings = match method {
                ContactMethod::RapierSkinSim => RapierSettings::skin_sim(system, n),
                ContactMethod::RapierTuned => RapierSettings {
                    solver_iterations: n,
                    ..RapierSettings::tuned(system)
                },
                _ => RapierSettings {
                    solver_iterations: n,
                    ..RapierSettings::with_engine_defaults(system)
                },
            };
            Ok(Box::new(RapierWorld::new(system, settings)?))
        }
        // The plan omits methods that this build does not contain; the quasi-static method does not step.
        _ => Ok(Box::new(ImplicitEuler::new(system))),
    }
}

/// Computes the equilibrium of one free ball, or of several balls stacked in a tube, by the quasi-static method. The balls may rotate and move sideways.
fn put_to_rest(scene: &ConfigurationScene, mass: f64) -> Result<Answer> {
    let test_bed = &scene.test_bed;
    let n_balls = test_bed.configuration.scene.n_balls();
    let spheres = test_bed.ball.spheres().expect("a ball is a sphere");
    let ball = FreeObject::new(spheres, mass, DVec3::ZERO)?;
    let skin = PlacedSkin::new(&test_bed.patch, Pose::IDENTITY);
    let gravity = -GRAVITY * DVec3::Z;
    let planes = match n_balls {
        1 => Vec::new(),
        _ => test_bed.tube(),
    };
    let ground = Ground {
        skins: vec![skin],
        planes,
        ..Ground::default()
    };
    let starts: Vec<Pose> = test_bed.stack(n_balls).collect();
    let balls = vec![ball; n_balls];
    let balances = EquilibriumSolver::new().solve_all(&balls, &ground, gravity, &starts)?;
    let mut workspace = Workspace::new();
    let poses: Vec<Pose> = balances.iter().map(|balance| balance.pose).collect();
    let models = vec![test_bed.ball.clone(); n_balls];
    Press::new(&test_bed.patch, &models, &poses, Until::Pose).run(&mut workspace)?;
    let imbalances = balances.iter().map(|balance| match balance.outcome {
        EquilibriumOutcome::AtRest => balance.imbalance,
        _ => f64::INFINITY,
    });
    Ok(Answer {
        force_imbalance: imbalances.fold(0.0, f64::max),
        deflection: workspace.deflections().to_vec(),
        ..Answer::default()
    })
}

/// Lowers a ball that moves only vertically until the taxels' springs carry its weight, by the quasi-static method.
fn press_to_weight(scene: &ConfigurationScene) -> Result<Answer> {
    let (test_bed, weight) = (&scene.test_bed, scene.force);
    let ball = from_ref(&test_bed.ball);
    let above = [Pose::from_translation(
        test_bed.pose.translation + 1e-3 * DVec3::Z,
    )];
    let mut workspace = Workspace::new();
    let press = Press::new(&test_bed.patch, ball, &above, Until::Force(weight))
        .with_contacts()
        .run(&mut workspace)?;
    let carried = spring_load(&test_bed.patch, workspace.contacts()).spring_force;
    Ok(Answer {
        force_imbalance: press.map_or(f64::INFINITY, |_| (carried / weight - 1.0).abs()),
        deflection: workspace.deflections().to_vec(),
        ..Answer::default()
    })
}

/// Simulates a ball with imposed motion on damped taxels by the quasi-static method.
fn press_and_release(scene: &ConfigurationScene, plan: &VelocityPlan) -> Result<Answer> {
    let test_bed = &scene.test_bed;
    let (dt, patch) = (test_bed.configuration.dt_s, &test_bed.patch);
    let ball = from_ref(&test_bed.ball);
    let frames = scene.frames();
    let mut state = DamperState::at_rest(patch.n_taxels());
    let mut workspace = Workspace::new();
    let mut answer = Answer {
        n_steps: frames[frames.len() - 1],
        ..Answer::default()
    };
    for step in 1..=answer.n_steps {
        let pose = plan.pose_at(step as f64 * dt);
        Press::new(patch, ball, &[pose], Until::Pose).run(&mut workspace)?;
        state.step(patch.taxels(), dt, workspace.deflections());
        if step == frames[0] {
            let force: f64 = state.force.iter().sum();
            answer.force_imbalance = (force / scene.force - 1.0).abs();
            answer.deflection.clone_from(&state.deflection);
        }
    }
    answer.left_over = state.deflection.iter().sum();
    Ok(answer)
}

fn judge(scene: &ConfigurationScene, answer: &Answer) -> StabilityScore {
    let configuration = scene.test_bed.configuration;
    let wanted = &scene.truth.deflection;
    let all: f64 = wanted.iter().sum();
    let pairs = || answer.deflection.iter().zip(wanted);
    let off: f64 = pairs().map(|(felt, wanted)| (felt - wanted).abs()).sum();
    let error = (off / all).max(answer.left_over / all);
    let touched = pairs().filter(|(_, wanted)| **wanted > 0.0);
    let in_all = touched.map(|(felt, _)| felt).sum::<f64>() / all;
    let is_held = answer.force_imbalance.is_finite() && (0.5..=2.0).contains(&in_all);
    let worst = error.max(answer.force_imbalance);
    let outcome = match answer.broken {
        Some(how) => how,
        None if worst.is_nan() => Outcome::NotFinite,
        None if !is_held => Outcome::MissedContact,
        None if worst > TOLERANCE => Outcome::Inaccurate,
        None => Outcome::Right,
    };
    let mass = configuration.object_mass_kg;
    let is_whole = answer.broken.is_none();
    StabilityScore {
        mass_ratio: mass.map(|mass| mass / configuration.taxel_mass_kg),
        explicit_limit_s: 2.0
            * (configuration.taxel_mass_kg / configuration.stiffness_n_per_m).sqrt(),
        damping_n_s_per_m: scene.test_bed.taxel.damping,
        contact_stiffness_n_per_m: None,
        outcome,
        force_imbalance: is_whole.then_some(answer.force_imbalance),
        deflection_error: is_whole.then_some(error),
        n_steps: answer.n_steps,
        simulated_s: (answer.n_steps > 0).then_some(answer.n_steps as f64 * configuration.dt_s),
    }
}
