//! How detailed must an object be, so that the skin feels no difference, and what does detail cost?
//!
//! A file with an `[object_detail]` table is such a study: [`ObjectDetailStudySpec`] (as written) → [`ObjectDetailPlan`]
//! (checked, SI) → [`ObjectDetailStudy`] → tables of [`rows`].
//!
//! Each mesh is touched exactly ([`MeshModel`](crate::objects::MeshModel)); then sphere models of it are read with the patch
//! at the very same places:
//!
//! - **error**: |δ − δ\*|, mean over the taxels of all touches that the mesh (δ\*) or the model (δ) touches.
//! - **error after offset**: the same with the patch drawn back by the constant distance, one for all touches of a model, that
//!   makes the error least. A model that is only inflated has none left.
//! - **error past own contact**: each touch as far past the model's own first contact as the mesh past its.
//!
//! With an `[object_detail.recognition]` table classifiers learn from each level of models, and are tested on other touches of
//! the meshes themselves: what a coarse object costs a skin that meets the real one.

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
