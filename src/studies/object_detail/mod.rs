//! Object-detail studies: the model detail that a skin can detect, and its cost.
//!
//! A file with an `[object_detail]` table is an object-detail study: [`ObjectDetailStudySpec`] (as written) → [`ObjectDetailPlan`]
//! (checked, SI) → [`ObjectDetailStudy`] → tables of [`rows`].
//!
//! Each mesh is touched exactly ([`MeshModel`](crate::objects::MeshModel)); then sphere models of the mesh are pressed with the patch at the same places:
//!
//! - **error**: |δ − δ\*|, mean over the taxels of all touches that the mesh (δ\*) or the model (δ) touches.
//! - **error after offset**: the error with the patch retracted by a constant distance. The distance is the same for all touches of a model and minimises the
//!   error. A uniformly inflated model has no error after offset.
//! - **error past own contact**: the error if model and mesh are pressed to equal depths past their own first contact.
//!
//! With an `[object_detail.recognition]` table, classifiers are trained on each kind of model and tested on other touches of the exact meshes. This measures
//! the loss of accuracy if training uses coarse objects.

mod charts;
mod deflection;
mod measured;
mod plan;
mod recognition;
pub mod rows;
mod spec;
mod study;
mod summary;
mod variants;

pub use crate::studies::object_detail::plan::ObjectDetailPlan;
pub use crate::studies::object_detail::spec::{
    DetailMethod, DetailRecognitionSpec, ObjectDetailSpec, ObjectDetailStudySpec,
};
pub use crate::studies::object_detail::study::{DetailRows, ObjectDetailStudy};
