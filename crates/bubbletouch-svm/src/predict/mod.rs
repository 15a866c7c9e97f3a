//! Prediction: decision values and labels, computed by matrix products.

pub(crate) mod class_weights;
pub(crate) mod condorcet_winner;
pub(crate) mod decision;
pub mod svm_model;
pub mod voting;
