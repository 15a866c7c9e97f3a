//! A kind of study: how far can each setting be driven before recognition breaks?
//!
//! A file with `[[breaking_points]]` tables is such a study: a recognition study without axes of its own (but that of its
//! classifiers), and ways to drive it, one key or a few at a time. [`BreakingPointsSpec`] (as written) →
//! [`BreakingPointsPlan`] (checked: each value of each way is a recognition [`Plan`](super::Plan)) → [`BreakingPointsStudy`] →
//! [`table::BreakingPointsTables`].
//!
//! A way **breaks** a classifier where its mean accuracy, going outwards from its best, first falls to half of the best:
//! between two values where a straight line on the axis' scale says so. The interval of that place is from repeated draws of
//! all accuracies out of what their test rows leave open (`half`).

mod half;
mod plan;
mod runner;
mod scale;
mod spec;
pub mod table;
mod value;

pub use plan::{BreakingPointsPlan, N_OBJECTS, PlannedValue, PlannedWay};
pub use runner::{BreakingPointsStudy, DrivenRows};
pub use scale::WayScale;
pub use spec::{BreakingPointsSpec, DrivenAs, DrivenTouches, WaySpec};
