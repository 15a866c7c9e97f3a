//! How strong a step is: the checks that several steps share.

use crate::error::{Error, Result};

/// The value, if it is zero or more.
pub(super) fn not_negative(place: &str, value: f64) -> Result<f64> {
    if value.is_finite() && value >= 0.0 {
        return Ok(value);
    }
    Err(Error::input(place, value, "zero or a positive number"))
}

/// The value, if it is from 0 to 1.
pub(super) fn fraction(place: &str, value: f64) -> Result<f64> {
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    Err(Error::input(place, value, "a fraction, 0 to 1"))
}
