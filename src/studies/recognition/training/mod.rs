//! Training of classifiers and scores of trials.

pub mod next_touch;
pub mod training;
pub mod trial;
