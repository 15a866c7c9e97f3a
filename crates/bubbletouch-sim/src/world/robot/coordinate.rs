//! Coordinates of joints: dimensions, order and names of a robot's joint positions.

use std::f64::consts::PI;

/// Physical dimension of a joint coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Angle, radians.
    Angle,
    /// Length, metres.
    Length,
}

impl Dimension {
    /// Returns the SI unit of the dimension.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Angle => "rad",
            Self::Length => "m",
        }
    }

    /// Returns the suffixes of column names for this dimension, and the size of each unit in SI units; the first suffix is empty.
    pub fn units(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Angle => &[("", 1.0), ("_rad", 1.0), ("_deg", PI / 180.0)],
            Self::Length => &[("", 1.0), ("_m", 1.0), ("_mm", 1e-3)],
        }
    }
}

/// One coordinate of a robot's joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinate {
    /// Name of the coordinate, which is the name of its joint. For joints with several coordinates, `.x`, `.y`, `.z`, `.theta`, `.roll`, `.pitch` or `.yaw` is
    /// appended.
    pub name: String,
    /// Index of the joint that has this coordinate.
    pub joint: usize,
    /// Physical dimension of the coordinate.
    pub dimension: Dimension,
}
