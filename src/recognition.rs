//! Recognition: training of classifiers on labelled measurements, and their evaluation on other measurements.
//!
//! | stage | input | output |
//! |---|---|---|
//! | [`data`] | features y (n_rows × m), labels `0..n_classes` | a checked [data set](data::dataset), [split](data::split) into training and test rows, on one [scale](data::scaling) |
//! | [`features`] | frames, or measurements of them | features that are invariant to constant pressure, stiffness, position or rotation |
//! | [`classifiers`] | training rows | a [trained classifier](classifiers::trained_classifier) of any [kind](ClassifierKind) |
//! | [`svm`] | training rows | soft-margin [SVMs](svm), and the [choice](svm::cross_validation::choice) of their C and γ |
//! | [`evaluation`] | labels | a [confusion matrix](evaluation::metrics), [decisions on several touches](evaluation::fusion), [the next touch](evaluation::next_touch) |
//! | [`statistics`] | scores of trials | [intervals](statistics::interval), [comparisons](statistics::comparison), [variance components](statistics::variance) |
//!
//! A classifier fits its scaling, its parameters and its model on training rows only; test rows are only predicted.
//! All results are deterministic, because random numbers come from a named [`Seed`](crate::random::Seed).
//!
//! ```
//! use bubbletouch::random::Seed;
//! use bubbletouch::recognition::ClassifierKind;
//! use bubbletouch::recognition::classifiers::classifier::{Classifier, predict_split};
//! use bubbletouch::recognition::data::dataset::dataset;
//! use bubbletouch::recognition::evaluation::metrics::ConfusionMatrix;
//! use bubbletouch::recognition::data::split::stratified_hold_out;
//! use ndarray::{Array1, Array2, Axis};
//!
//! // Two objects, twenty touches of each, two measurements a touch.
//! let features = Array2::from_shape_fn((40, 2), |(i, j)| (i % 2) as f64 + 0.3 * ((i + j) as f64).sin());
//! let data = dataset(features, Array1::from_iter((0..40).map(|i| i % 2)))?;
//! let split = stratified_hold_out(data.targets.view(), 0.25, &Seed::new(2018))?;
//! // Any classifier that implements linfa's traits can be used here.
//! let predicted = predict_split(&Classifier::new(ClassifierKind::LinearSvm), &data, &split)?;
//! let foreign = predict_split(&linfa_bayes::GaussianNb::params(), &data, &split)?;
//! assert_eq!(foreign, predicted);
//! let truth = data.targets.select(Axis(0), &split.test);
//! assert_eq!(ConfusionMatrix::new(truth.view(), predicted.view(), 2)?.accuracy(), 1.0);
//! # Ok::<(), bubbletouch::Error>(())
//! ```

pub use crate::learning::classifiers::{ClassifierAbout, ClassifierKind, Train};
pub use crate::learning::model_file::ModelFile;
pub use crate::learning::{classifiers, data, evaluation};
pub use crate::statistics;
pub use bubbletouch_sim::features;
#[doc(inline)]
pub use bubbletouch_svm as svm;
