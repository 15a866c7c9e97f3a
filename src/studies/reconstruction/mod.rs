//! Reconstruction studies: the accuracy of frames that are reconstructed from m measurements.
//!
//! A file with a `[reconstruction]` table in place of `[recognition]` is a reconstruction study:
//! [`ReconstructionStudySpec`] (as written) → [`ReconstructionPlan`] (checked, SI) → [`ReconstructionStudy`] → [its tables](rows).
//!
//! Noise is added to the taxel readings before they are multiplied by Φ. Dictionaries, covariances and the choice of atoms are computed from the **clean**
//! frames of training touches, which a simulation provides. These computations use no test touches.

mod charts;
mod frames;
mod measured;
mod plan;
pub mod rows;
mod study;
mod touches;

pub use crate::studies::reconstruction::plan::{
    ReconstructionPlan, ReconstructionSpec, ReconstructionStudySpec,
};
pub use crate::studies::reconstruction::study::ReconstructionStudy;
