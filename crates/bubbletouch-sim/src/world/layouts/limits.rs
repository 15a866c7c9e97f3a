//! Limits of layouts: numbers of taxels and angles.

use crate::error::{Error, Result};

/// Taxels of one layout, at most: more is a pitch in the wrong unit, and a hundred bytes each.
pub const MAX_TAXELS: usize = 1 << 22;

/// Refuses layouts without taxels, and those with more than [`MAX_TAXELS`]; `about`: how many there will be.
pub(super) fn check_count(place: &str, about: f64) -> Result<()> {
    if about >= 1.0 && about <= MAX_TAXELS as f64 {
        return Ok(());
    }
    Err(Error::input(
        place,
        format!("{about:.0} taxels"),
        format!("1 to {MAX_TAXELS}"),
    ))
}

/// The error is an angle that is not above zero, or larger than `largest` radians.
pub(super) fn check_angle(place: &str, angle: f64, largest: f64) -> Result<()> {
    if angle > 0.0 && angle <= largest {
        return Ok(());
    }
    Err(Error::input(
        place,
        format!("{angle} rad"),
        format!("above 0 to {largest}"),
    ))
}
