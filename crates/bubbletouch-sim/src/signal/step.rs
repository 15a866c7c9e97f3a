//! Steps of a signal chain.

use super::{MAX_STRENGTHS, Noise, SENSOR_ERRORS, SensorError};
use crate::error::{Error, Result};
use crate::random::Seed;

/// Step of a signal chain, as listed in the file of a study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SignalStep {
    /// Converts deflections to forces.
    Force,
    /// Adds Gaussian noise.
    Noise(Noise),
    /// Smooths the frame with a Gaussian kernel.
    Smoothing {
        /// Standard deviation of the Gaussian kernel, metres, zero or positive.
        width: f64,
    },
    /// Applies a sensor error.
    Error {
        /// Type of the sensor error.
        error: SensorError,
        /// Strengths of the sensor error, zero or positive.
        strengths: [f64; MAX_STRENGTHS],
        /// Seed of the skin that has the sensor error.
        skin: Seed,
    },
}

impl SignalStep {
    /// Returns how many of the earlier steps are noise, if this step is noise, or have the same sensor error.
    pub(super) fn repetition(&self, earlier: &[Self]) -> u64 {
        let is_same = |other: &&Self| match (self, other) {
            (Self::Error { error, .. }, Self::Error { error: other, .. }) => error == other,
            _ => std::mem::discriminant(self) == std::mem::discriminant(*other),
        };
        earlier.iter().filter(is_same).count() as u64
    }

    /// Returns whether the readings of a touch depend on the touches before it.
    pub(super) fn remembers(&self) -> bool {
        matches!(self, Self::Error { error, .. } if error.about().remembers)
    }
}

impl SensorError {
    /// Returns the signal step of this sensor error with the strengths `given`; missing strengths are zero. `skin` is the seed of the skin.
    ///
    /// # Errors
    /// If more strengths are given than the sensor error has. [`Chain::new`](super::Chain::new) checks their values.
    pub fn step(self, given: &[f64], skin: Seed) -> Result<SignalStep> {
        let n_strengths = self.about().strengths.len();
        if given.len() > n_strengths {
            return Err(Error::input(
                format!("strengths of {}", self.about().step),
                format!("{} numbers", given.len()),
                format!("at most {n_strengths}"),
            ));
        }
        let mut strengths = [0.0; MAX_STRENGTHS];
        strengths[..given.len()].copy_from_slice(given);
        Ok(SignalStep::Error {
            error: self,
            strengths,
            skin,
        })
    }

    /// Returns the sensor error whose signal step has the name `word`; `None` if there is none.
    pub fn of_step(word: &str) -> Option<Self> {
        let mut all = SENSOR_ERRORS.iter().copied();
        all.find(|error| error.about().step == word)
    }
}

/// Returns the seed of a repeated sensor error, which draws its own numbers; the first step of an error has the given seed.
pub(super) fn seed_of_repetition(seed: &Seed, repetition: u64) -> Seed {
    match repetition {
        0 => *seed,
        n => seed.named("repetition").numbered(n),
    }
}
