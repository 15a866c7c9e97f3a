//! Stability studies: the masses and time steps for which each contact simulation method gives correct results.
//!
//! A file with a `[stability]` table is a stability study: [`StabilityStudySpec`] (as written) → [`StabilityPlan`] (checked, SI) →
//! [`run_whole`](crate::studies::study::run_whole) → [its tables](rows).
//!
//! In each of five [scenes](StabilityScene), a ball is lowered onto a square array. The ball touches all taxels within a quarter of their stroke. In two
//! scenes, two or four balls are stacked in a smooth tube. Without friction, a free stack has no stable upright state. In the tube, the taxels carry the
//! whole weight and the walls carry nothing.
//!
//! In every scene, the exact result is known at one time without time stepping. Either the motion of the ball determines the deflections, or the springs carry
//! the weight. Each method is evaluated at this time:
//!
//! - **force imbalance**: |Σ f − expected| / expected, at the end of the simulation or, for an imposed motion, at the end of the hold.
//! - **deflection error**: Σ |δ − δ\*| / Σ δ\* at this time. For an imposed motion, the error also includes the time after the release, when all deflections
//!   must be zero.
//! - **outcome**: [`right`](Outcome::Right) if both errors are at most [`TOLERANCE`], otherwise [`inaccurate`](Outcome::Inaccurate). A simulation fails if a
//!   number is not finite, the energy exceeds the energy of the scene, or contact is missed. Contact is missed if deflections are below half of the expected
//!   values, or the ball is below the stops.
//!
//! Dynamic methods run until the slowest motion of a scene has decayed to 5e-5, and for at least [`LEAST_STEPS`] steps and half a second.

mod charts;
mod configuration;
mod plan;
pub mod rows;
mod scene;
mod spec;
mod study;

pub use crate::studies::stability::plan::StabilityPlan;
pub use crate::studies::stability::rows::{Outcome, TOLERANCE};
pub use crate::studies::stability::scene::LEAST_STEPS;
pub use crate::studies::stability::spec::{
    ContactMethod, StabilityPartSpec, StabilityScene, StabilitySpec, StabilityStudySpec,
};
