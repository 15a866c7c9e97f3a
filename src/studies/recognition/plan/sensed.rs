//! Quantities that the taxels of an array measure.

use crate::random::Seed;
use crate::world::Shear;
use serde::Serialize;

/// Quantity that a taxel reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub enum Sensed {
    /// Deflection, metres; a step of the signal chain may convert it to a force.
    #[default]
    Deflection,
    /// Force along the taxel's axis, newtons.
    Force,
    /// Forces along and across the taxel's axis, newtons: three channels. The second and third channels are along x and y of the taxel's frame. Springs with
    /// the given parameters produce the forces across the axis.
    Shear(Shear),
}

impl Sensed {
    /// Returns the number of values that each taxel reads.
    pub fn n_channels(&self) -> usize {
        match self {
            Self::Deflection | Self::Force => 1,
            Self::Shear(_) => 3,
        }
    }

    /// Returns the name of the quantity for texts, such as `force`.
    pub fn words(&self) -> &'static str {
        match self {
            Self::Deflection => "deflection",
            Self::Force => "force",
            Self::Shear(_) => "force and shear",
        }
    }
}

/// Returns the random seed for one of the channels (quantities) that a taxel reads. The first channel has the seed `named` itself.
pub(crate) fn of_channel(named: &Seed, channel: usize) -> Seed {
    match channel {
        0 => *named,
        _ => named.named("channel").numbered(channel as u64),
    }
}
