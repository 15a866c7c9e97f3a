//! Wrenches: forces with their torques about an origin.

use glam::DVec3;
use std::ops::{Add, Neg};

/// Force, and its torque about the origin of the patch frame; both in the patch frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force in the patch frame, N.
    pub force: DVec3,
    /// Torque about the origin of the patch frame, N·m.
    pub torque: DVec3,
}

impl Wrench {
    /// Returns the wrench of a force (newtons) that acts at a point (metres), both in the patch frame.
    pub fn at(point: DVec3, force: DVec3) -> Self {
        Self {
            force,
            torque: point.cross(force),
        }
    }
}

impl Add for Wrench {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            force: self.force + other.force,
            torque: self.torque + other.torque,
        }
    }
}

impl Neg for Wrench {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            force: -self.force,
            torque: -self.torque,
        }
    }
}
