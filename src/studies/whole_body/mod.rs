//! What does a step of a whole body of skin cost, and is the way from touch to answer within its millisecond?
//!
//! A file with a `[whole_body]` table is such a study: [`WholeBodyStudySpec`] (as written) → [`WholeBodyPlan`] (checked, SI) →
//! [`run_whole`](crate::studies::study::run_whole) → [its tables](rows).
//!
//! 1. **Scenes**: an object goes along its path on a robot that is covered in skin ([`CoveredRobot`](crate::whole_body::CoveredRobot)).
//!    Each step is pressed, what is touched is compressed ([`Columns`](crate::sensing::Columns)), and a linear SVM says what it is.
//! 2. **Recognition**: that SVM has learned from simulated touches of some objects, and is tested on others of the same objects.
//! 3. **Ladders**: what a step costs as the skin grows at the same touch, as the touch grows on the same skin, and with the spheres
//!    of the object, on bodies of equal sleeves under a cushion of spheres.
//!
//! Counts, sums and decisions are the same bytes at any number of threads; times have tables of their own.

mod charts;
mod drive;
mod ladders;
mod memory_chart;
mod objects;
mod path;
mod picture;
mod plan;
mod recognition;
pub mod rows;
mod spec;
mod steps;
mod study;

pub use crate::studies::whole_body::path::Path;
pub use crate::studies::whole_body::plan::{Aim, ScenePlan, WholeBodyPlan};
pub use crate::studies::whole_body::spec::{
    BodyPartSpec, BodyRecognitionSpec, BodySceneSpec, BodySensingSpec, LaddersSpec, WholeBodySpec,
    WholeBodyStudySpec,
};
