//! The coordinates of joints: what a position vector holds, and by which names.

use std::f64::consts::PI;

/// What a coordinate measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Radians.
    Angle,
    /// Metres.
    Length,
}

impl Dimension {
    /// Its SI unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Angle => "rad",
            Self::Length => "m",
        }
    }

    /// What a name with its unit ends in, and the size of that unit in SI; first a bare name.
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
    /// The joint's name; for joints of several coordinates with `.x`, `.y`, `.z`, `.theta`, `.roll`, `.pitch` or `.yaw` after
    /// it.
    pub name: String,
    /// Index of the joint.
    pub joint: usize,
    /// What it measures.
    pub dimension: Dimension,
}
