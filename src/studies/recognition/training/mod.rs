//! Training of classifiers, and scores of trials.

pub mod evaluation_inputs;
pub mod fit;
pub mod next_touch;
pub mod trial;

pub(crate) use self::next_touch::*;
pub use self::{evaluation_inputs::*, fit::*, trial::*};
