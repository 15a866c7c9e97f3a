//! Decision values and labels, by matrix products.

pub(crate) mod class_weights;
pub(crate) mod decision;
pub mod svm_model;
pub(crate) mod unbeaten;
pub mod voting;
