//! Labelled rows: data sets, splits, scaling, and deliberate defects of training data.

pub use bubbletouch_svm::{dataset, scaling, split};
pub mod spoiled;
pub mod temporal_features;
