//! Checks of the numbers of a press, common to all public presses: goal, direction, and size of the output. `check_poses` checks the poses.

use super::Goal;
use crate::error::{Error, Result};
use crate::text::in_range::{finite, not_negative, positive};
use glam::DVec3;

/// Returns an error unless the output of a press has one value for each taxel.
pub(super) fn check_output(n_values: usize, n_taxels: usize) -> Result<()> {
    if n_values == n_taxels {
        return Ok(());
    }
    let given = format!("{n_values} values for {n_taxels} taxels");
    Err(Error::input(
        "output of a press",
        given,
        "one value for each taxel",
    ))
}

/// Returns an error unless the direction is a unit vector.
pub(super) fn check_direction(direction: DVec3) -> Result<()> {
    if direction.is_finite() && (direction.length() - 1.0).abs() < 1e-9 {
        return Ok(());
    }
    Err(Error::input(
        "touch direction",
        direction,
        "a vector of length one",
    ))
}

impl Goal {
    /// Returns an error if the number of the goal is out of its range.
    pub(in crate::contact) fn check(self) -> Result<()> {
        match self {
            Self::Pose => Ok(()),
            Self::Depth(depth) => not_negative("touch depth", depth, "m").map(drop),
            Self::Travel(travel) => finite("touch travel", travel, "m").map(drop),
            Self::Force(force) => positive("touch force", force, "N").map(drop),
        }
    }
}
