//! Presses to a force: accuracy of the force, and the error for an unreachable force.

use crate::error::Error;

/// Relative accuracy of the force in a press to a force, unless one bit of the travel changes the force by more. If larger, repeated presses differ visibly;
/// if smaller, rounding of the sum of forces adds needless steps.
pub(super) const FORCE_ACCURACY: f64 = 1e-13;

/// Creates the error for a press to a `force` (newtons) above the `largest` reachable force. `where_to` describes the state at the largest force.
pub(super) fn unreachable_force(force: f64, largest: f64, where_to: &str) -> Error {
    Error::input(
        "touch force",
        format!("{force} N"),
        format!("up to {largest:.6} N, where {where_to}"),
    )
}
