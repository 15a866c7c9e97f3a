//! Quantities that the taxels of an array read.

use crate::random::Seed;
use crate::world::Shear;

/// Quantity that a taxel reads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Sensed {
    /// Deflection, metres; a step of the signal chain may convert it to a force.
    #[default]
    Deflection,
    /// Force along the taxel's axis, newtons.
    Force,
    /// Forces along and across the taxel's axis, newtons, with the given shear springs: three channels. The second and third channel are along x and y of the
    /// taxel's frame.
    Shear(Shear),
}

impl Sensed {
    /// Returns the number of values per taxel.
    pub fn n_channels(&self) -> usize {
        match self {
            Self::Deflection | Self::Force => 1,
            Self::Shear(_) => 3,
        }
    }

    /// Returns the name of the quantity in words.
    pub fn words(&self) -> &'static str {
        match self {
            Self::Deflection => "deflection",
            Self::Force => "force",
            Self::Shear(_) => "force and shear",
        }
    }
}

/// Returns the random seed of a channel; the first channel has the given seed.
pub(crate) fn of_channel(named: &Seed, channel: usize) -> Seed {
    match channel {
        0 => *named,
        _ => named.named("channel").numbered(channel as u64),
    }
}
