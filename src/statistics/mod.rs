//! How sure scores are: intervals, comparisons, and what each source of chance brings.

pub mod bootstrap;
pub mod comparison;
pub mod grouped;
pub mod many_tests;
pub(crate) mod mean_squares;
pub mod p_status;
pub mod rank_correlation;
pub mod repeats;
pub mod variance;

pub use bubbletouch_sim::statistics::interval;
