//! Machine learning on labelled rows: classifiers and scores. This module does not depend on touch data.
//!
//! | module | input → output |
//! |---|---|
//! | [`data`] | labelled rows → checked data sets, splits, one scale |
//! | [`classifiers`] | training rows → trained classifiers of any kind |
//! | [`command_classifier`] | training rows → labels of test rows, by a program |
//! | [`model_file`] | trained classifier ↔ file |
//! | [`evaluation`] | predicted labels → confusion matrices, decisions on several touches, the next touch |

pub mod command_classifier;
pub mod data;
pub mod evaluation;
pub mod model_file;

pub use bubbletouch_svm::classifiers;
