//! The coordinates of joints: what a position vector holds, and by which names.

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
