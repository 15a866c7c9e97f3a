//! Evaluation of predicted labels: metrics, fusion of several touches, and choice of the next touch.

pub mod fusion;
pub mod metrics;
pub mod next_touch;
