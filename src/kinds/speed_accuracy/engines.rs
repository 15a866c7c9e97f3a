//! A touch stepped through time, by each method that there is.
//!
//! The object comes down with [`SPEED`] from first contact to its depth and is held until the slowest motion of a taxel has died out;
//! then the deflections are read. Taxels have SkinSim's mass and the damper that is best for it.

use super::rows::ContactWay;
use crate::contact::simulate;
use crate::dynamics::{
    Drive, ImplicitEuler, Integrator, SemiImplicit, Steps, System, run, skin_sim,
};
use crate::error::Result;
use crate::geometry::Pose;
use crate::kinds::object_detail::Reading;
use crate::objects::Model;
use crate::study::taxel_array::TaxelArray;
use crate::world::{Patch, Phase, Taxel, VelocityPlan};
use glam::DVec3;

/// Of the object on its way, m/s.
const SPEED: f64 = 0.05;
/// A hold leaves e to the minus this of a taxel's motion, 5e-5.
const DECAY: f64 = 10.0;
/// Steps of a touch, at least.
const LEAST_STEPS: f64 = 5.0;

/// The methods of this build.
pub(super) const METHODS: &[ContactWay] = &[
    ContactWay::TimeSteps,
    ContactWay::ImplicitEuler,
    ContactWay::SemiImplicit,
    #[cfg(feature = "rapier")]
    ContactWay::Rapier,
];

/// The patch of an array of which each taxel has the damper that is best for it: critical, so that the slowest rate is √(k / m).
pub(super) fn damped(array: &TaxelArray) -> Result<Patch> {
    let taxel = *array.taxel();
    let damping = 2.0 * (taxel.stiffness * skin_sim::TAXEL_MASS).sqrt();
    Patch::grid(*array.grid(), Taxel { damping, ..taxel })
}

/// Steps a [damped] patch through a touch of a model, by a method among [`METHODS`] with a time step (s); everything that it takes
/// counts, but for the patch. Deflections (n_taxels, metres; none where the motion diverged), and how many steps.
pub(super) fn step_through(
    (patch, model): (&Patch, &Model),
    (method, dt): (ContactWay, f64),
    reading: &Reading,
) -> Result<(Option<Vec<f64>>, usize)> {
    let (k, m) = (patch.taxels().at(0).stiffness, skin_sim::TAXEL_MASS);
    let way = reading.depth / SPEED;
    let hold = DECAY / (k / m).sqrt();
    let n_steps = ((way + hold) / dt).ceil().max(LEAST_STEPS) as usize;
    let pressed = reading.pressed();
    let above = pressed.translation + reading.depth * DVec3::Z;
    let start = Pose::new(pressed.rotation, above);
    let down = Phase {
        duration: way,
        linear: -SPEED * DVec3::Z,
        angular: DVec3::ZERO,
    };
    let plan = VelocityPlan::new(start, vec![down])?;
    if method == ContactWay::TimeSteps {
        let objects = [model.clone()];
        let still = VelocityPlan::new(Pose::IDENTITY, Vec::new())?;
        let recording = simulate(patch, &objects, &still, &[plan], dt, n_steps)?;
        let last = recording.deflection.row(n_steps - 1);
        return Ok((Some(last.to_vec()), n_steps));
    }
    let drive = Drive::Imposed(plan);
    // No further: where an object comes is found by a press so deep, and small spheres would be behind the substrate by then.
    let reach = reading.depth;
    let system = System::new(patch, m, model, start, drive, reach)?;
    let steps = Steps {
        dt,
        n: n_steps,
        frames: &[n_steps],
        energy_limit: f64::INFINITY,
    };
    let found = run(&system, integrator(&system, (method, dt))?.as_mut(), &steps)?;
    let last = || found.recording.deflection.row(0).to_vec();
    Ok((found.divergence.is_none().then(last), n_steps))
}

fn integrator(system: &System, (method, dt): (ContactWay, f64)) -> Result<Box<dyn Integrator>> {
    match method {
        ContactWay::SemiImplicit => {
            let stiffness = SemiImplicit::stiffest(system, dt, 1);
            Ok(Box::new(SemiImplicit::new(system, stiffness)))
        }
        #[cfg(feature = "rapier")]
        ContactWay::Rapier => {
            use crate::dynamics::{RapierSettings, RapierWorld};
            let settings = RapierSettings::tuned(system);
            Ok(Box::new(RapierWorld::new(system, settings)?))
        }
        _ => Ok(Box::new(ImplicitEuler::new(system))),
    }
}
