//! The steps that a chain can have.

use super::{MAX_STRENGTHS, Noise, SENSOR_ERRORS, SensorError};
use crate::random::Seed;

/// One step from deflections to frames, as a study names it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SignalStep {
    /// Deflections become forces.
    Force,
    /// Gaussian noise is added.
    Noise(Noise),
    /// The frame is smoothed.
    Smoothing {
        /// σ of the Gaussian, metres, zero or positive.
        width: f64,
    },
    /// A sensor error.
    Error {
        /// Which.
        error: SensorError,
        /// Its [strengths](super::ErrorAbout::strengths), zero or more.
        strengths: [f64; MAX_STRENGTHS],
        /// The name of the skin that it belongs to.
        skin: Seed,
    },
}

impl SignalStep {
    /// Whether what a touch reads depends on the touches before it.
    pub(super) fn remembers(&self) -> bool {
        matches!(self, Self::Error { error, .. } if error.about().remembers)
    }
}

impl SensorError {
    /// The step that does it at some strengths, those that are not given being zero, of the skin of a name.
    pub fn step(self, given: &[f64], skin: Seed) -> SignalStep {
        let mut strengths = [0.0; MAX_STRENGTHS];
        strengths[..given.len()].copy_from_slice(given);
        SignalStep::Error {
            error: self,
            strengths,
            skin,
        }
    }

    /// The one of a step's word.
    pub fn of_step(word: &str) -> Option<Self> {
        let mut all = SENSOR_ERRORS.iter().copied();
        all.find(|error| error.about().step == word)
    }
}
