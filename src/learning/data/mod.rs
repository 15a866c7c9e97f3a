//! Labelled rows: data sets, splits, scaling, and deliberate defects of training data.

pub use bubbletouch_svm::{dataset, scaling, split};
pub mod over_time;
pub mod spoiled;
