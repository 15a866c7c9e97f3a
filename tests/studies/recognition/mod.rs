//! Classifiers, splits and the choice of the next touch.

mod classifier;
mod kinds;
mod limits;
mod next_touch;
mod splits;
