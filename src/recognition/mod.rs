//! Recognition: labelled measurements → classifier, scores.
//!
//! | enters | leaves |
//! |---|---|
//! | features y (n_rows × m) and labels `0..n_classes`: [`dataset`] | labels, a [confusion matrix](metrics), [intervals](interval), [comparisons](comparison) |
//!
//! Rows are [split] into training and test rows; a [`Classifier`](classifier::Classifier) learns its
//! [scaling], the [choice of C](choice) and its [SVM](svm) from training rows alone, and test rows are only
//! ever predicted. Everything is deterministic; whatever is drawn comes from a named [`Seed`](crate::random::Seed).
//!
//! A binary soft-margin SVM decides by the sign of `f(x) = Σ_i y_i a_i K(x_i, x) − ρ`, where the multipliers minimise
//! `½ Σ_ij a_i a_j y_i y_j K(x_i, x_j) − Σ_i a_i` over `0 ≤ a_i ≤ C`, `Σ_i y_i a_i = 0`; [`binary`] solves it by
//! linfa-svm, [`svm`] makes one classifier of many.
//!
//! ```
//! use bubbletouch::random::Seed;
//! use bubbletouch::recognition::ClassifierKind;
//! use bubbletouch::recognition::classifier::{Classifier, predict_split};
//! use bubbletouch::recognition::dataset::dataset;
//! use bubbletouch::recognition::metrics::ConfusionMatrix;
//! use bubbletouch::recognition::split::stratified_hold_out;
//! use ndarray::{Array1, Array2, Axis};
//!
//! // Two objects, twenty touches of each, two measurements a touch.
//! let features = Array2::from_shape_fn((40, 2), |(i, j)| (i % 2) as f64 + 0.3 * ((i + j) as f64).sin());
//! let data = dataset(features, Array1::from_iter((0..40).map(|i| i % 2)))?;
//! let split = stratified_hold_out(data.targets.view(), 0.25, &Seed::new(2018))?;
//! // Any classifier that implements linfa's traits can stand here.
//! let predicted = predict_split(&Classifier::new(ClassifierKind::LinearSvm), &data, &split)?;
//! let truth = data.targets.select(Axis(0), &split.test);
//! assert_eq!(ConfusionMatrix::new(truth.view(), predicted.view(), 2)?.accuracy(), 1.0);
//! # Ok::<(), bubbletouch::Error>(())
//! ```

use serde::{Deserialize, Serialize};

pub mod binary;
pub mod choice;
pub mod classifier;
pub mod comparison;
pub mod dataset;
pub mod features;
pub mod fusion;
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
