//! Classifiers without a kernel that repeat exactly: the same rows and seed give the same model on every machine.

pub mod class_model;
pub mod k_nearest;
pub(crate) mod lbfgs;
pub mod logistic_regression;
pub mod naive_bayes;
pub mod nearest_centroid;
pub mod random_forest;
pub(crate) mod ranked;
pub(crate) mod tree;
