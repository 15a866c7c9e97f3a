//! Statistics: quantiles, confidence intervals, and bounds for tests of random quantities.
//!
//! | module | input → output |
//! |---|---|
//! | [`quantile`] | values → a quantile |
//! | [`interval`] | counts or values → an estimate with its interval |
//! | [`standard_errors`] | an estimate and its standard error → a test against its expected value |

pub mod interval;
pub mod quantile;
pub mod standard_errors;
