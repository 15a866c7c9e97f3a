//! Coordinates of joints: dimensions, order and names of a robot's positions.

use std::f64::consts::PI;

/// Physical dimension of a coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Angle, radians.
    Angle,
    /// Length, metres.
    Length,
}

impl Dimension {
    /// Returns the SI unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Angle => "rad",
            Self::Length => "m",
        }
    }

    /// Returns suffixes of column names and the sizes of their units in SI; the first suffix is empty.
    pub fn units(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Angle => &[("", 1.0), ("_rad", 1.0), ("_deg", PI / 180.0)],
            Self::Length => &[("", 1.0), ("_m", 1.0), ("_mm", 1e-3)],
        }
    }
}

/// One number of a robot's positions.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinate {
    /// Name of the joint. For joints of several coordinates `.x`, `.y`, `.z`, `.theta`, `.roll`, `.pitch` or `.yaw` is
    /// appended.
    pub name: String,
    /// Index of the joint.
    pub joint: usize,
    /// Physical dimension.
    pub dimension: Dimension,
}
