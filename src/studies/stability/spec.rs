//! Specification of a stability study: the keys of its TOML file.

use crate::engine::axis::Axis;
use crate::files::FilePath;
use crate::inputs::defaults::number;
use crate::study_file::toml_file;
use serde::{Deserialize, Serialize};

/// The study file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StabilityStudySpec {
    /// The question of the study, in one sentence.
    pub question: String,
    /// The author's expectation before the first run.
    #[serde(default)]
    pub expected: String,
    /// Settings of the simulations.
    pub stability: StabilitySpec,
}

/// `[stability]`: scenes and simulation methods to compare.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StabilitySpec {
    /// Distance between neighbouring taxels, mm; the radius of a taxel is half of it.
    #[serde(default = "number::<4>")]
    pub pitch_mm: f64,
    /// Table that other programs wrote (`benches/peers/stability.py`), relative to the study file; ignored if the file does not exist.
    pub peers: Option<FilePath>,
    /// Parts of the study, run one after the other; each part combines all values of its axes.
    pub parts: Vec<StabilityPartSpec>,
}

/// `[[stability.parts]]`: a part of the study, which combines all values of its axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StabilityPartSpec {
    /// Simulated scene.
    pub scene: StabilityScene,
    /// Simulation methods.
    pub methods: Vec<ContactMethod>,
    /// Axis: number of taxels along a side of the array.
    pub taxels: Axis<usize>,
    /// Stroke s of a taxel, mm.
    #[serde(default = "number::<2>")]
    pub stroke_mm: f64,
    /// Axis: stiffness k of a taxel, N/m.
    pub stiffness_n_per_m: Axis<f64>,
    /// Axis: mass m of a taxel, kg. Quasi-static taxels have no mass.
    pub taxel_mass_kg: Axis<f64>,
    /// Axis: mass M of each ball, kg. Required if the balls are free, not allowed if their motion is imposed.
    pub object_mass_kg: Option<Axis<f64>>,
    /// Axis, instead of `object_mass_kg`: M divided by the number of taxels, kg, so that each taxel carries the same load on all arrays.
    pub object_mass_per_taxel_kg: Option<Axis<f64>>,
    /// Axis: time step Δt, s.
    pub dt_s: Axis<f64>,
    /// Axis: iterations of an engine's solver per step; for [`RapierSkinSim`](ContactMethod::RapierSkinSim), the number of sweeps.
    #[serde(default = "default_iterations")]
    pub solver_iterations: Axis<usize>,
}

/// Scene with one or more balls on a square array of taxels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StabilityScene {
    /// A ball is lowered to first contact and released. The dampers stop it without oscillation:
    /// `c = 2 √(k (M / n + m))`, where n taxels carry the ball at rest.
    Rest,
    /// The motion of a ball is imposed: from 2 mm above the array, at 0.5 m/s, to half the stroke, a pause, and back at the same speed. The damping
    /// of a taxel is 0.508 of critical, as in SkinSim.
    Press,
    /// A ball is released as in `rest`, with SkinSim's dampers: c / k = 0.13 / 16.37 s.
    Plunger,
    /// Two equal balls, one on top of the other in a smooth square tube of their width, are released as in `rest`. `object_mass_kg` is the mass of each ball.
    StackOfTwo,
    /// Four equal balls in a tube, as in `stack_of_two`.
    StackOfFour,
}

impl StabilityScene {
    /// Returns the number of balls.
    pub fn n_balls(self) -> usize {
        match self {
            Self::Rest | Self::Press | Self::Plunger => 1,
            Self::StackOfTwo => 2,
            Self::StackOfFour => 4,
        }
    }
}

/// Method that simulates contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContactMethod {
    /// Ours: massless taxels, solved in closed form. [`balance`](crate::contact::equilibrium) is used for rest,
    /// [`Approach::press_to_force`](crate::contact::Approach::press_to_force) under a plunger, and [`DamperState`](crate::contact::DamperState) over time.
    QuasiStatic,
    /// [`SemiImplicit`](crate::dynamics::SemiImplicit) with the better of two contact stiffnesses. One limits the penetration to 1/400 of the deflection or
    /// stroke; the other is the largest stable stiffness at the given time step.
    SemiImplicit,
    /// [`ImplicitEuler`](crate::dynamics::ImplicitEuler): implicit Euler steps with exact contact.
    ImplicitEuler,
    /// rapier with default settings, except for the unit of length. Requires the feature `rapier`; omitted without it.
    RapierAsItComes,
    /// rapier with settings tuned for skin. Requires the feature `rapier`; omitted without it.
    RapierTuned,
    /// rapier with the settings that SkinSim gives its engine: springs and dampers as forces, taxels on a light base, rigid contacts. Requires the
    /// feature `rapier`; omitted without it.
    RapierSkinSim,
    /// MuJoCo with default settings: Euler integrator, soft contacts. All MuJoCo methods exist only in the table [`peers`](StabilitySpec::peers).
    MujocoEuler,
    /// MuJoCo with the integrator `implicitfast` and soft contacts.
    MujocoImplicitfast,
    /// MuJoCo with the integrator `discrete` and the hardest possible contacts.
    MujocoDiscrete,
}

impl ContactMethod {
    /// Returns whether this build contains the method.
    pub fn is_built(self) -> bool {
        !self.is_engine() || cfg!(feature = "rapier")
    }

    /// Returns whether the method's results come from another program's table.
    pub fn is_peer(self) -> bool {
        matches!(
            self,
            Self::MujocoEuler | Self::MujocoImplicitfast | Self::MujocoDiscrete
        )
    }

    /// Returns whether `solver_iterations` applies to the method.
    pub fn is_engine(self) -> bool {
        matches!(
            self,
            Self::RapierAsItComes | Self::RapierTuned | Self::RapierSkinSim
        )
    }
}

toml_file!(StabilityStudySpec);

fn default_iterations() -> Axis<usize> {
    Axis::One(4)
}
