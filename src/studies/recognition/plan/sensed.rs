//! What the taxels of an array read of a touch.

use crate::random::Seed;
use crate::world::Shear;

/// What a taxel reads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Sensed {
    /// How far it is pushed in: metres, until a step of the signal makes it a force.
    #[default]
    Deflection,
    /// The force along its axis, newtons.
    Force,
    /// The forces along and across its axis, newtons, with these shear springs at the tips: three channels, of which the second and the third are
    /// along x and y of the taxel's [frame](crate::world::Layout::frame).
    Shear(Shear),
}

impl Sensed {
    /// Numbers that a taxel reads.
    pub fn n_channels(&self) -> usize {
        match self {
            Self::Deflection | Self::Force => 1,
            Self::Shear(_) => 3,
        }
    }

    /// What people call it.
    pub fn words(&self) -> &'static str {
        match self {
            Self::Deflection => "deflection",
            Self::Force => "force",
            Self::Shear(_) => "force and shear",
        }
    }
}

/// The name of a channel of something that has a name.
pub(crate) fn of_channel(named: &Seed, channel: usize) -> Seed {
    match channel {
        0 => *named,
        _ => named.named("channel").numbered(channel as u64),
    }
}
