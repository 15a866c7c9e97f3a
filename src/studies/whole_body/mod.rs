//! Whole-body studies: the computing time of a step of a robot's whole skin, from touch to recognition. The target is one millisecond.
//!
//! A file with a `[whole_body]` table is a whole-body study: [`WholeBodyStudySpec`] (as written) → [`WholeBodyPlan`] (checked, SI) →
//! [`run_whole`](crate::studies::study::run_whole) → [its tables](rows).
//!
//! 1. **Scenes**: an object moves along a path over a robot that is covered with skin. In each step, the contact is simulated, the readings of touched taxels
//!    are compressed, and a linear SVM recognises the object.
//! 2. **Recognition**: the SVM is trained on simulated touches of some objects, and tested on other touches of the same objects.
//! 3. **Scaling**: the computing time per step is measured while the skin, the touch, or the object's number of spheres grows. The skin consists of equal
//!    cylinders under a cushion of spheres.
//!
//! Counts, sums and decisions do not depend on the number of threads; times are in separate tables.

mod charts;
mod drive;
mod ladders;
mod plan;
mod recognition;
pub mod rows;
mod spec;
mod steps;
mod study;

pub use crate::studies::whole_body::plan::{Aim, ScenePlan, WholeBodyPlan};
pub use crate::studies::whole_body::spec::{
    BodyRecognitionSpec, BodySceneSpec, BodySensingSpec, LaddersSpec, WholeBodySpec,
    WholeBodyStudySpec,
};
