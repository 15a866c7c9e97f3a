//! Statistics of scores: confidence intervals, significance tests, and variance components.

pub mod bootstrap;
pub mod comparison;
pub mod grouped;
pub mod many_tests;
pub mod p_status;
pub mod rank_correlation;
pub mod repeats;
pub mod variance;

pub use bubbletouch_sim::statistics::interval;
