//! Range checks of numbers; the error states the allowed range.

use crate::error::{Error, Result};

/// Checks that a number is finite and positive; the error contains `unit`.
///
/// # Errors
/// If the value is infinite, NaN or not positive.
pub fn positive(place: &str, value: f64, unit: &str) -> Result<f64> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(Error::input(
        place,
        format!("{value} {unit}"),
        "a finite positive number",
    ))
}

/// Checks that a number is finite and not negative; the error contains `unit`, which may be empty.
///
/// # Errors
/// If the value is infinite, NaN or negative.
pub fn not_negative(place: &str, value: f64, unit: &str) -> Result<f64> {
    if value.is_finite() && value >= 0.0 {
        return Ok(value);
    }
    let given = format!("{value} {unit}");
    Err(Error::input(
        place,
        given.trim_end(),
        "zero or a positive number",
    ))
}

/// Checks that a number is from 0 to 1.
///
/// # Errors
/// If the value is outside 0 to 1, or NaN.
pub fn fraction(place: &str, value: f64) -> Result<f64> {
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    Err(Error::input(place, value, "a fraction, 0 to 1"))
}
