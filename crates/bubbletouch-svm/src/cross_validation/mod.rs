//! Choice of C and γ by cross-validation; all folds and candidates share one matrix of inner products.

pub(crate) mod alpha_seeding;
pub mod choice;
pub(crate) mod fold_path;
pub(crate) mod grid;
pub(crate) mod validation_scorer;
