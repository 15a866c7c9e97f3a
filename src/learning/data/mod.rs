//! Labelled rows: which train and which test, on which scale, and what is wrong with them.

pub use bubbletouch_svm::{dataset, scaling};
pub mod over_time;
pub mod split;
pub mod spoiled;
