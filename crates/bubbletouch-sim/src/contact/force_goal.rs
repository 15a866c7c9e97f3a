//! Presses to a force: accuracy of the travel, and the error for an unreachable force.

use crate::error::Error;

/// Accuracy of a force, relative to the force, unless one bit of the travel changes the force by more. Larger: repeated presses differ visibly;
/// smaller: rounding of the sum of forces decides, and the search takes needless steps.
pub(super) const FORCE_ACCURACY: f64 = 1e-13;

/// Creates the error for a force (newtons) above the `largest` one; `where_to` describes the state at the largest force.
pub(super) fn unreachable_force(force: f64, largest: f64, where_to: &str) -> Error {
    Error::input(
        "touch force",
        format!("{force} N"),
        format!("up to {largest:.6} N, where {where_to}"),
    )
}
