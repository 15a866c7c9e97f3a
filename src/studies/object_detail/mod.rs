//! Object-detail studies, which measure how much model detail a skin can detect, and the cost of this detail.
//!
//! A file with an `[object_detail]` table is an object-detail study: [`ObjectDetailStudySpec`] (as written) → [`ObjectDetailPlan`]
//! (checked, SI) → [`ObjectDetailStudy`] → tables of [`rows`].
//!
//! Each mesh is touched exactly. Sphere models of the mesh are then pressed with the patch in the same poses:
//!
//! - **error**: mean of |δ − δ\*| over the taxels of all touches that the mesh (δ\*) or the model (δ) touches.
//! - **error after offset**: the error with the patch retracted by a constant distance. The distance is equal for all touches of a model and minimises the
//!   error. A uniformly inflated model has no error after offset.
//! - **error past own contact**: the error if the model and the mesh are pressed to equal depths past their own first contact.
//!
//! With a table `[object_detail.recognition]`, classifiers are trained on each kind of model and tested on other touches of the exact meshes. The test
//! accuracies show the loss that is caused by coarse objects in training.

mod charts;
mod deflection;
mod measured;
mod plan;
mod recognition;
pub mod rows;
mod study;

pub use crate::studies::object_detail::plan::{
    DetailMethod, DetailRecognitionSpec, ObjectDetailPlan, ObjectDetailSpec, ObjectDetailStudySpec,
};
pub use crate::studies::object_detail::study::{DetailRows, ObjectDetailStudy};
