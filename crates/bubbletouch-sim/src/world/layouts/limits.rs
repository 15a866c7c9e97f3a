//! Limits of layouts: numbers of taxels and angles.

use crate::error::{Error, Result};

/// Maximum number of taxels of a layout, each of about a hundred bytes. A larger number indicates a pitch in the wrong unit.
pub const MAX_TAXELS: usize = 1 << 22;

/// Returns an error if a layout has no taxels or more than [`MAX_TAXELS`]; `about` is the expected number of taxels.
pub(super) fn check_count(place: &str, about: f64) -> Result<()> {
    if about >= 1.0 && about <= MAX_TAXELS as f64 {
        return Ok(());
    }
    let given = format!("{about:.0} taxels");
    let allowed = format!("1 to {MAX_TAXELS}");
    Err(Error::input(place, given, allowed))
}

/// Returns an error unless an angle is above zero and at most `largest` radians.
pub(super) fn check_angle(place: &str, angle: f64, largest: f64) -> Result<()> {
    if angle > 0.0 && angle <= largest {
        return Ok(());
    }
    let given = format!("{angle} rad");
    let allowed = format!("above 0 to {largest}");
    Err(Error::input(place, given, allowed))
}
