//! The steps that a chain can have.

use super::{Drift, Faults, GainMismatch, Noise};

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
    /// Loading and unloading read differently.
    Hysteresis {
        /// Width of the loop between zero and full scale, in its middle: a fraction of the full scale, 0 to 0.25.
        width: f64,
    },
    /// Values leak to the neighbours.
    Crosstalk {
        /// κ, the fraction that leaks, 0 to 1.
        leak: f64,
    },
    /// Each taxel has its own gain.
    Gain(GainMismatch),
    /// Each taxel's zero wanders from touch to touch.
    Drift(Drift),
    /// Some taxels are dead or stuck.
    Faults(Faults),
    /// Taxels are read one after another.
    Scan {
        /// T, the time to read the whole array, seconds, zero or positive.
        seconds: f64,
    },
    /// A converter clips and rounds.
    Quantisation {
        /// b, 1 to 24; 0 for no converter.
        bits: u32,
    },
}
