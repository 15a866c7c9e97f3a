//! Recognition: labelled measurements → classifier, scores.

use serde::{Deserialize, Serialize};

pub mod binary;
pub mod choice;
pub mod classifier;
pub mod comparison;
pub mod dataset;
pub mod interval;
pub mod kernel;
pub mod metrics;
pub mod scaling;
pub mod split;
pub mod svm;
pub mod svm_model;

/// A classifier that a study can sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClassifierKind {
    /// Soft-margin SVM, linear kernel.
    LinearSvm,
    /// Soft-margin SVM, Gaussian kernel `exp(−γ|x − z|²)`.
    RbfSvm,
    /// Soft-margin SVM, polynomial kernel `(γ x·z + c₀)^d`.
    PolynomialSvm,
}
