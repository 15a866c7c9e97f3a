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
use crate::world::{Patch, Phase, Scene, SkinPatch, Taxel, VelocityPlan};
use glam::DVec3;

/// Of the object on its way, m/s.
const SPEED: f64 = 0.05;
/// A hold leaves e to the minus this of a taxel's motion, 5e-5.
const DECAY: f64 = 10.0;
/// Steps of a touch, at least.
const LEAST_STEPS: f64 = 5.0;

/// How a touch is stepped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StepMethod {
    QuasiStatic,
    ImplicitEuler,
    SemiImplicit,
    #[cfg(feature = "rapier")]
    Rapier,
}

/// A method with a time step, on a patch and an object.
pub(super) struct Stepper<'a> {
    pub patch: &'a Patch,
    pub model: &'a Model,
    pub method: StepMethod,
    pub dt: f64,
}

/// What came of a touch.
pub(super) struct Stepped {
    /// n_taxels, metres; none where the motion diverged.
    pub deflections: Option<Vec<f64>>,
    pub n_steps: usize,
}

impl StepMethod {
    /// Those that this build has.
    pub fn built() -> Vec<Self> {
        vec![
            Self::QuasiStatic,
            Self::ImplicitEuler,
            Self::SemiImplicit,
            #[cfg(feature = "rapier")]
            Self::Rapier,
        ]
    }

    pub fn way(self) -> ContactWay {
        match self {
            Self::QuasiStatic => ContactWay::TimeSteps,
            Self::ImplicitEuler => ContactWay::ImplicitEuler,
            Self::SemiImplicit => ContactWay::SemiImplicit,
            #[cfg(feature = "rapier")]
            Self::Rapier => ContactWay::Rapier,
        }
    }
}

impl Stepper<'_> {
    /// Steps through a touch; everything that it takes counts, scene and all.
    pub fn touch(&self, reading: &Reading) -> Result<Stepped> {
        let (k, m) = (self.patch.taxel.stiffness, skin_sim::TAXEL_MASS);
        let taxel = Taxel {
            // Critical: the slowest rate is then √(k / m).
            damping: 2.0 * (k * m).sqrt(),
            ..self.patch.taxel
        };
        let patch = Patch {
            taxel,
            ..*self.patch
        };
        let way = reading.depth / SPEED;
        let hold = DECAY / (k / m).sqrt();
        let n_steps = ((way + hold) / self.dt).ceil().max(LEAST_STEPS) as usize;
        let pressed = reading.pressed();
        let above = pressed.translation + reading.depth * DVec3::Z;
        let start = Pose::new(pressed.rotation, above);
        let plan = descent(start, way)?;
        if self.method == StepMethod::QuasiStatic {
            let scene = Scene::of_one(&patch, self.model);
            let still = VelocityPlan::new(Pose::IDENTITY, Vec::new())?;
            let recording = simulate(&scene, &still, &[plan], self.dt, n_steps)?;
            let last = recording.deflection.row(n_steps - 1);
            return Ok(Stepped {
                deflections: Some(last.to_vec()),
                n_steps,
            });
        }
        let skin = SkinPatch::from(patch);
        let drive = Drive::Imposed(plan);
        // No further: where an object comes is found by a press so deep, and small spheres would be behind the substrate by then.
        let reach = reading.depth;
        let system = System::new(&skin, m, self.model, start, drive, reach)?;
        let mut integrator = self.integrator(&system)?;
        let steps = Steps {
            dt: self.dt,
            n: n_steps,
            frames: &[n_steps],
            energy_limit: f64::INFINITY,
        };
        let recording = run(&system, integrator.as_mut(), &steps)?;
        let is_whole = recording.divergence.is_none();
        Ok(Stepped {
            deflections: is_whole.then(|| recording.recording.deflection.row(0).to_vec()),
            n_steps,
        })
    }

    fn integrator(&self, system: &System) -> Result<Box<dyn Integrator>> {
        match self.method {
            StepMethod::SemiImplicit => {
                let stiffness = SemiImplicit::stiffest(system, self.dt, 1);
                Ok(Box::new(SemiImplicit::new(system, stiffness)))
            }
            #[cfg(feature = "rapier")]
            StepMethod::Rapier => {
                use crate::dynamics::{RapierSettings, RapierWorld};
                let settings = RapierSettings::tuned(system);
                Ok(Box::new(RapierWorld::new(system, settings)?))
            }
            StepMethod::QuasiStatic | StepMethod::ImplicitEuler => {
                Ok(Box::new(ImplicitEuler::new(system)))
            }
        }
    }
}

/// From there down with [`SPEED`].
fn descent(start: Pose, way_s: f64) -> Result<VelocityPlan> {
    let down = Phase {
        duration: way_s,
        linear: -SPEED * DVec3::Z,
        angular: DVec3::ZERO,
    };
    VelocityPlan::new(start, vec![down])
}
