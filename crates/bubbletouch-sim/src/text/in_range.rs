//! Numbers that are in their range, or the error that says which numbers are.

use crate::error::{Error, Result};

/// A finite number above zero, in a unit.
///
/// # Errors
/// The value is infinite, NaN or not above zero.
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

/// A finite number that is not below zero, in a unit; empty without one.
///
/// # Errors
/// The value is infinite, NaN or below zero.
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

/// A number from 0 to 1.
///
/// # Errors
/// The value is outside 0 to 1, or NaN.
pub fn fraction(place: &str, value: f64) -> Result<f64> {
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    Err(Error::input(place, value, "a fraction, 0 to 1"))
}
