//! Where does each way to simulate contact break?
//!
//! A file with a `[stability]` table is such a study: [`StabilityStudySpec`] (as written) → [`StabilityPlan`] (checked, SI) →
//! [`run_whole`](crate::studies::study::run_whole) → [its tables](rows).
//!
//! A ball comes down on a **cradle**, a square patch whose taxels it meets nearly all at once (all within a quarter of their stroke), in
//! one of five [scenes](StabilityScene). Two or four balls lie one upon the other in a smooth tube, since without friction a stack that
//! nothing holds has no rest but the one in which it lies down; upright in the tube the taxels carry all of its weight, and the walls
//! nothing. Every scene has a moment at which the exact answer is known without any time stepping (the
//! taxels are where the ball holds them; the springs carry its weight, [`rest`](crate::dynamics::rest)), and is judged there:
//!
//! - **force imbalance**: |Σ f − what it must be| as a share of that, at the end (of the hold, if the ball's motion is imposed).
//! - **deflection error**: Σ |δ − δ\*| / Σ δ\*, there, and for an imposed ball also after the release, where all taxels are out.
//! - **outcome**: [`right`](Outcome::Right) if both are at most [`TOLERANCE`]; else [`inaccurate`](Outcome::Inaccurate), unless it broke: a
//!   number is not finite, there is more energy than the scene can have, or contact was missed (taxels are not half as far in as they
//!   must be, or the ball is through the stops).
//!
//! Dynamic methods run until the slowest motion of a scene has died out to 5e-5, at least [`LEAST_STEPS`] steps and half a second.

mod cell;
mod charts;
mod peers;
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
