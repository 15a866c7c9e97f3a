//! How far can each setting be driven before recognition breaks?
//!
//! A file with `[[breaking_points]]` tables is such a study: a recognition study without axes of its own (but that of its
//! classifiers), and axes along which it is searched, its ways: any key of the study, or a few at a time. [`BreakingPointsSpec`] (as written) →
//! [`BreakingPointsPlan`] (checked: each value of each way is a recognition [`Plan`](crate::studies::recognition::plan::plan::Plan)) → [`BreakingPointsStudy`] →
//! tables of [`rows`].
//!
//! A way **breaks** a classifier where its mean accuracy, going outwards from its best, first falls to half of the best:
//! between two values where a straight line on the axis' scale says so. The interval of that place is from repeated draws of
//! all accuracies out of what their test rows leave open (`half`).

mod charts;
mod half;
mod plan;
pub mod rows;
mod scale;
mod spec;
mod study;
mod value;

pub use crate::studies::breaking_points::plan::{BreakingPointsPlan, PlannedValue, PlannedWay};
pub use crate::studies::breaking_points::scale::WayScale;
pub use crate::studies::breaking_points::spec::{
    BreakingPointsSpec, DrivenAs, DrivenTouches, WaySpec,
};
pub use crate::studies::breaking_points::study::{BreakingPointsStudy, DrivenRows};
