//! Labelled rows: which train and which test, on which scale, and what is wrong with them.

pub use bubbletouch_svm::{dataset, scaling, split};
pub mod over_time;
pub mod spoiled;
