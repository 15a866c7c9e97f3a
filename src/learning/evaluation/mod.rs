//! What predicted labels are worth, of one touch and of several.

pub mod fusion;
pub mod metrics;
pub mod next_touch;
