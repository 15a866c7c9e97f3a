//! Keys of a stability study.

use crate::files::FilePath;
use crate::studies::prelude::*;
use crate::study_file::toml_file;

/// Default number of iterations of an engine's contact solver per step.
pub const SOLVER_ITERATIONS: usize = 4;

params! {
    /// Contents of a stability study file.
    pub struct StabilityStudySpec {
        /// Question that the study answers, in one sentence.
        question: String => Unchecked, Note, Never;
        /// Answer that the author expected before the first run. Default: empty.
        expected: String = String::new() => Unchecked, Note, Never;
        /// Table `[stability]`: scenes, and the simulation methods that are compared on them.
        stability: StabilitySpec;
    }
}

params! {
    /// Keys of `[stability]`: scenes and simulation methods to compare.
    pub struct StabilitySpec {
        /// Distance between neighbouring taxels, mm, positive; the radius of a taxel is half of it. Default: 4.
        pitch_mm: f64 = 4.0 => Positive, Choice, Never;
        /// Table of results of another program (`benches/peers/stability.py`), relative to the study file. Each row must belong to a scene of the study. If the
        /// file does not exist, the study has no such rows.
        peers: Option<FilePath> => Unchecked, Note, Never;
        /// Tables `[[stability.parts]]`: parts of the study, run one after the other. Each part combines all values of its axes.
        parts: Vec<StabilityPartSpec>;
    }
}

params! {
    /// Keys of `[[stability.parts]]`: a part of the study, which combines all values of its axes.
    pub struct StabilityPartSpec {
        /// Scene that is simulated.
        scene: StabilityScene => Any, Condition, Never;
        /// Methods that simulate the contact, at least one.
        methods: Vec<ContactMethod> => Any, Choice, Table;
        /// Axis: number of taxels along a side of the square array, even, at most 256.
        taxels: Axis<usize> => COUNT, Choice, Table;
        /// Stroke s of a taxel, mm, positive. Default: 2.
        stroke_mm: f64 = 2.0 => Positive, Choice, Never;
        /// Axis: stiffness k of a taxel, N/m, positive.
        stiffness_n_per_m: Axis<f64> => Positive, Choice, Table;
        /// Axis: mass m of a taxel, kg, positive. Quasi-static taxels have no mass.
        taxel_mass_kg: Axis<f64> => Positive, Choice, Table;
        /// Axis: mass M of each ball, kg, positive. Required if the balls are free to move; not allowed if their motion is imposed.
        object_mass_kg: Option<Axis<f64>> => Positive, Condition, Table;
        /// Axis: mass M of the ball divided by the number of taxels, kg, so that each taxel carries the same load on all arrays. Replaces `object_mass_kg`.
        object_mass_per_taxel_kg: Option<Axis<f64>> => Positive, Condition, Table;
        /// Axis: time step Δt, s, positive.
        dt_s: Axis<f64> => Positive, Choice, Table;
        /// Axis: number of iterations of an engine's contact solver per step, at least 1. For the method `rapier_skin_sim`, it is the number of sweeps over all
        /// contacts. Default: 4.
        solver_iterations: Axis<usize> = Axis::One(SOLVER_ITERATIONS) => COUNT, Choice, Table;
    }
}

words! {
    /// Scene of a stability study: one or more balls on a square array of taxels.
    pub enum StabilityScene {
        /// A ball is lowered until first contact and then released. The dampers stop it without oscillation: `c = 2 √(k (M / n + m))`, where n taxels carry the
        /// ball at rest.
        Rest = "rest",
        /// A ball moves at 0.5 m/s from 2 mm above the array to half the stroke, pauses, and returns at the same speed. The damping of a taxel is 0.508 of
        /// critical, as in SkinSim.
        Press = "press",
        /// A ball that can only move vertically is released as in `rest`. The taxels have the dampers of SkinSim, with a ratio of damping to stiffness of c / k =
        /// 0.13 / 16.37 s.
        Plunger = "plunger",
        /// Two equal balls are stacked in a smooth square tube of their width and released as in `rest`. `object_mass_kg` is the mass of each ball.
        StackOfTwo = "stack_of_two",
        /// Four equal balls are stacked in a tube and released, as in `stack_of_two`.
        StackOfFour = "stack_of_four",
    }
}

impl StabilityScene {
    /// Returns the number of balls in the scene.
    pub fn n_balls(self) -> usize {
        match self {
            Self::Rest | Self::Press | Self::Plunger => 1,
            Self::StackOfTwo => 2,
            Self::StackOfFour => 4,
        }
    }
}

words! {
    /// Method that simulates the contact between balls and taxels.
    pub enum ContactMethod {
        /// Method of this library: massless taxels, solved in closed form. Balls at rest are computed by the equilibrium solver, plungers by a press to a force,
        /// and motions over time with damper states.
        QuasiStatic = "quasi_static",
        /// Semi-implicit Euler steps with the better of two contact stiffnesses. One stiffness limits the penetration to 1/400 of the deflection or stroke. The
        /// other stiffness is the largest that is stable for the time step.
        SemiImplicit = "semi_implicit",
        /// Implicit Euler steps that satisfy the contact conditions exactly.
        ImplicitEuler = "implicit_euler",
        /// The engine rapier with default settings except for the unit of length. Requires the feature `rapier`; omitted without it.
        RapierAsItComes = "rapier_as_it_comes",
        /// The engine rapier with settings tuned for skin. Requires the feature `rapier`; omitted without it.
        RapierTuned = "rapier_tuned",
        /// The engine rapier with the settings of SkinSim: springs and dampers as forces, taxels on a light base, rigid contacts. Requires the feature `rapier`;
        /// omitted without it.
        RapierSkinSim = "rapier_skin_sim",
        /// The engine MuJoCo with default settings: Euler integrator, soft contacts. Results of MuJoCo exist only in the table `peers`.
        MujocoEuler = "mujoco_euler",
        /// The engine MuJoCo with the integrator `implicitfast` and soft contacts.
        MujocoImplicitfast = "mujoco_implicitfast",
        /// The engine MuJoCo with the integrator `discrete` and the hardest possible contacts.
        MujocoDiscrete = "mujoco_discrete",
    }
}

impl ContactMethod {
    /// Returns whether this build contains the method.
    pub fn is_built(self) -> bool {
        !self.is_engine() || cfg!(feature = "rapier")
    }

    /// Returns whether the results of the method are read from a table of another program.
    pub fn is_peer(self) -> bool {
        self.word().starts_with("mujoco_")
    }

    /// Returns whether the method is a physics engine, to which the key `solver_iterations` applies.
    pub fn is_engine(self) -> bool {
        self.word().starts_with("rapier_")
    }
}

toml_file!(StabilityStudySpec);
