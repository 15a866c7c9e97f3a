//! The choice of C and γ: all folds of a grid from one matrix of products.

pub mod choice;
pub(crate) mod fold_path;
pub(crate) mod grid;
pub(crate) mod judgement;
pub(crate) mod seed;
