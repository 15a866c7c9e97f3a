//! The choice of C and γ: all folds of a grid from one matrix of products.

pub(crate) mod alpha_seeding;
pub mod choice;
pub(crate) mod fold_path;
pub(crate) mod grid;
pub(crate) mod validation_scorer;
