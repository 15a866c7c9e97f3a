//! Evaluation of predicted labels: metrics, fusion of touches, and choice of the next touch.

pub mod fusion;
pub mod metrics;
pub mod next_touch;
