//! Range checks of numbers; the error states the allowed range.

use crate::error::{Error, Result};

/// Returns the number if it is finite and positive, otherwise an error that contains `unit`.
///
/// # Errors
/// If the value is infinite, NaN or not positive.
pub fn positive(place: &str, value: f64, unit: &str) -> Result<f64> {
    let allowed = "a finite positive number";
    finite_and(|value| value > 0.0, place, (value, unit), allowed)
}

/// Returns the number if it is finite and not negative, otherwise an error that contains `unit` (which may be empty).
///
/// # Errors
/// If the value is infinite, NaN or negative.
pub fn not_negative(place: &str, value: f64, unit: &str) -> Result<f64> {
    let allowed = "zero or a positive number";
    finite_and(|value| value >= 0.0, place, (value, unit), allowed)
}

/// Returns the number if it is finite, otherwise an error that contains `unit`.
///
/// # Errors
/// If the value is infinite or NaN.
pub fn finite(place: &str, value: f64, unit: &str) -> Result<f64> {
    finite_and(|_| true, place, (value, unit), "a finite number")
}

/// Returns the number if it is from 0 to 1, otherwise an error.
///
/// # Errors
/// If the value is outside 0 to 1, or NaN.
pub fn fraction(place: &str, value: f64) -> Result<f64> {
    let is_fraction = |value| (0.0..=1.0).contains(&value);
    finite_and(is_fraction, place, (value, ""), "a fraction, 0 to 1")
}

/// Returns the number if it is finite and `is_allowed` returns true.
fn finite_and(
    is_allowed: impl Fn(f64) -> bool,
    place: &str,
    (value, unit): (f64, &str),
    allowed: &str,
) -> Result<f64> {
    if value.is_finite() && is_allowed(value) {
        return Ok(value);
    }
    let given = format!("{value} {unit}");
    Err(Error::input(place, given.trim_end(), allowed))
}
