//! How sure scores are: intervals, comparisons, and what each source of chance brings.

pub mod bootstrap;
pub mod comparison;
pub mod grouped;
pub mod many_tests;
pub(crate) mod mean_squares;
pub mod rank_correlation;
pub mod variance;

pub use bubbletouch_sim::interval;
