//! The other kind of study: not which object was touched, but how well its frame comes back from m measurements.
//!
//! A file with a `[reconstruction]` table in place of `[recognition]` is such a study:
//! [`ReconstructionStudySpec`] (as written) → [`ReconstructionPlan`] (checked, SI) → [`ReconstructionStudy`] → [`table::ReconstructionTables`].
//!
//! Noise is on taxels, before Φ. Dictionaries, covariances and which atoms to keep are learned from the **clean** frames of
//! training touches, which a simulator has; test touches are never seen by them.

mod isometry;
mod job;
mod measured;
mod plan;
mod runner;
mod score;
mod spec;
pub mod table;
mod touches;

pub use plan::ReconstructionPlan;
pub use runner::ReconstructionStudy;
pub use spec::{ReconstructionSpec, ReconstructionStudySpec};
pub use touches::SampleFrames;
