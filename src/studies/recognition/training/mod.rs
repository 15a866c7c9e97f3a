//! Training of classifiers, and scores of trials.

pub mod evaluation_inputs;
pub mod fit;
pub mod next_touch;
pub mod trial;
