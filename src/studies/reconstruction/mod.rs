//! How well does a frame come back from m measurements?
//!
//! A file with a `[reconstruction]` table in place of `[recognition]` is such a study:
//! [`ReconstructionStudySpec`] (as written) → [`ReconstructionPlan`] (checked, SI) → [`ReconstructionStudy`] → [its tables](rows).
//!
//! Noise is on taxels, before Φ. Dictionaries, covariances and which atoms to keep are learned from the **clean** frames of
//! training touches, which a simulator has; test touches are never seen by them.

mod charts;
mod frames;
mod measured;
mod plan;
pub mod rows;
mod score;
mod spec;
mod study;
mod touches;

pub use crate::studies::reconstruction::plan::ReconstructionPlan;
pub use crate::studies::reconstruction::spec::{ReconstructionSpec, ReconstructionStudySpec};
pub use crate::studies::reconstruction::study::ReconstructionStudy;
