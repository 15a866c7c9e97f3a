//! A study of stability as it is written.

use crate::engine::axis::Axis;
use crate::files::FilePath;
use crate::inputs::defaults::number;
use crate::study_file::toml_file;
use serde::{Deserialize, Serialize};

/// The file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StabilityStudySpec {
    /// What the study asks, in a sentence.
    pub question: String,
    /// What the author expected before it ran.
    #[serde(default)]
    pub expected: String,
    /// What is tried.
    pub stability: StabilitySpec,
}

/// `[stability]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StabilitySpec {
    /// Between neighbouring taxels; they are balls of half as much.
    #[serde(default = "number::<4>")]
    pub pitch_mm: f64,
    /// A table that other programs wrote (`benches/peers/stability.py`), beside the study's file; left out where it is not.
    pub peers: Option<FilePath>,
    /// Products of axes that are tried, one after the other.
    pub parts: Vec<StabilityPartSpec>,
}

/// `[[stability.parts]]`: all combinations of its axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StabilityPartSpec {
    /// What happens.
    pub scene: StabilityScene,
    /// How it is simulated.
    pub methods: Vec<ContactMethod>,
    /// Axis: taxels a side.
    pub taxels: Axis<usize>,
    /// s.
    #[serde(default = "number::<2>")]
    pub stroke_mm: f64,
    /// Axis: k.
    pub stiffness_n_per_m: Axis<f64>,
    /// Axis: m. (Quasi-static taxels have none.)
    pub taxel_mass_kg: Axis<f64>,
    /// Axis: M of the ball, of each in a stack; needed where it is free, not there where its motion is imposed.
    pub object_mass_kg: Option<Axis<f64>>,
    /// In its place: M over the number of taxels, so that each carries the same on all arrays.
    pub object_mass_per_taxel_kg: Option<Axis<f64>>,
    /// Axis: Δt.
    pub dt_s: Axis<f64>,
    /// Axis: iterations of an engine's solver a step; of [`RapierSkinSim`](ContactMethod::RapierSkinSim), sweeps.
    #[serde(default = "default_iterations")]
    pub solver_iterations: Axis<usize>,
}

/// What happens to the ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StabilityScene {
    /// It is lowered to first contact and let go. The taxels' dampers are the best for it: they stop it without ringing,
    /// `c = 2 √(k (M / n + m))` with the n taxels that carry it at rest.
    Rest,
    /// Its motion is imposed: from 2 mm above, with 0.5 m/s to half the stroke, held, and back as fast. The dampers are 0.508 of critical
    /// for a taxel, as SkinSim's are.
    Press,
    /// It is let go as in `rest`, on SkinSim's dampers: c / k = 0.13 / 16.37 s.
    Plunger,
    /// Two equal balls, one upon the other, in a smooth square tube as wide as they are, are let go as in `rest`. The mass is that of each.
    StackOfTwo,
    /// Four of them.
    StackOfFour,
}

impl StabilityScene {
    /// How many balls there are.
    pub fn n_balls(self) -> usize {
        match self {
            Self::Rest | Self::Press | Self::Plunger => 1,
            Self::StackOfTwo => 2,
            Self::StackOfFour => 4,
        }
    }
}

/// How contact is simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContactMethod {
    /// Ours: taxels without mass, in closed form ([`balance`](crate::contact::equilibrium) at rest,
    /// [`Approach::press_to_force`](crate::contact::Approach::press_to_force) under a plunger, [`DamperState`](crate::contact::DamperState) over time).
    QuasiStatic,
    /// [`SemiImplicit`](crate::dynamics::SemiImplicit), the better of two contact stiffnesses: one that lets nothing sink in by more than a
    /// 400th of its deflection or stroke, and the stiffest that the step carries.
    SemiImplicit,
    /// [`ImplicitEuler`](crate::dynamics::ImplicitEuler).
    ImplicitEuler,
    /// rapier as it comes, but for its unit of length. Only with the feature `rapier`; left out without it.
    RapierAsItComes,
    /// rapier tuned for skin. Only with the feature `rapier`; left out without it.
    RapierTuned,
    /// rapier told what SkinSim tells its engine: springs and dampers as forces, taxels on a light base, rigid contacts. Only with the
    /// feature `rapier`; left out without it.
    RapierSkinSim,
    /// MuJoCo as it comes: Euler's integrator, soft contacts. Only in [`peers`](StabilitySpec::peers), as the next two.
    MujocoEuler,
    /// MuJoCo with its integrator `implicitfast`, soft contacts.
    MujocoImplicitfast,
    /// MuJoCo with its integrator `discrete`, contacts as hard as it gets.
    MujocoDiscrete,
}

impl ContactMethod {
    /// Whether this build has it.
    pub fn is_built(self) -> bool {
        !self.is_engine() || cfg!(feature = "rapier")
    }

    /// Whether it is another program's.
    pub fn is_peer(self) -> bool {
        matches!(
            self,
            Self::MujocoEuler | Self::MujocoImplicitfast | Self::MujocoDiscrete
        )
    }

    /// Whether solver iterations mean something to it.
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
