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
//! `½ Σ_ij a_i a_j y_i y_j K(x_i, x_j) − Σ_i a_i` over `0 ≤ a_i ≤ C`, `Σ_i y_i a_i = 0`; our own sequential
//! minimal optimisation solves it on Gram matrices that all problems of a data set share; [`svm`] makes one classifier of
//! many, and can have linfa-svm solve them instead. [`linear_svm`] trains the linear case without a kernel
//! matrix, and [`logistic_regression`], [`naive_bayes`], [`k_nearest`], [`decision_tree`] and [`random_forest`] stand beside it as
//! [`ClassModel`](class_model::ClassModel)s.
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
//! let foreign = predict_split(&linfa_bayes::GaussianNb::params(), &data, &split)?;
//! assert_eq!(foreign, predicted);
//! let truth = data.targets.select(Axis(0), &split.test);
//! assert_eq!(ConfusionMatrix::new(truth.view(), predicted.view(), 2)?.accuracy(), 1.0);
//! # Ok::<(), bubbletouch::Error>(())
//! ```

use serde::{Deserialize, Serialize};

mod active_set;
mod between;
pub mod bootstrap;
pub mod choice;
mod class_columns;
pub mod class_model;
mod class_products;
mod class_weights;
pub mod classifier;
#[macro_use]
mod classifier_about;
pub mod comparison;
pub(crate) mod coordinate_descent;
pub(crate) mod crammer_singer;
pub mod dataset;
mod decision;
pub mod dual;
mod election;
mod extent;
mod factors;
pub mod features;
mod few_dimensions;
mod first_rows;
mod fold_path;
mod free_factor;
pub mod fusion;
mod grid;
pub mod interval;
mod judgement;
pub mod kernel;
mod later_products;
pub(crate) mod lbfgs;
pub mod linear_model;
mod linfa_solver;
pub mod many_tests;
mod margin_pair;
mod margin_rows;
mod mean_squares;
pub mod metrics;
mod moved_row;
mod near_margin;
pub mod over_time;
mod packed;
mod pair_search;
mod panels;
#[cfg(target_arch = "x86_64")]
mod panels_512;
mod points;
mod product_kernel;
pub(crate) mod ranked;
mod row_products;
mod row_tiles;
mod scalar;
pub mod scaling;
mod seed;
mod smo;
mod sorted;
pub mod split;
pub mod spoiled;
pub mod svm;
pub mod svm_model;
pub mod trained_classifier;
mod training;
mod transposed;
mod unbeaten;
pub mod variance;
#[cfg(target_arch = "x86_64")]
mod vector_registers;
mod voting;

pub use classifier_about::{ClassifierAbout, Train};

// Everything that a study may say of a classifier follows from its line here and from the file that it names.
classifiers! {
    LinearSvm linear_svm "Soft-margin SVM, linear kernel.";
    RbfSvm rbf_svm "Soft-margin SVM, Gaussian kernel `exp(−γ|x − z|²)`.";
    PolynomialSvm polynomial_svm "Soft-margin SVM, polynomial kernel `(γ x·z + c₀)^d`.";
    LogisticRegression logistic_regression "Multinomial [logistic regression](logistic_regression).";
    KNearest k_nearest "[k nearest neighbours](k_nearest).";
    NearestCentroid nearest_centroid "The class whose mean is nearest: [nearest centroid](nearest_centroid).";
    NaiveBayes naive_bayes "Gaussian [naive Bayes](naive_bayes).";
    DecisionTree decision_tree "A single [classification tree](decision_tree).";
    RandomForest random_forest "A [random forest](random_forest).";
}
