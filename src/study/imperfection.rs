//! What real skins do to a signal, as a study names it: each imperfection's key, step, range and words.

use super::axis::Axis;
use super::spec::{SignalSpec, StepSpec};
use crate::random::Seed;
use crate::signal::{Drift, Faults, GainMismatch, SignalStep};
use crate::world::Grid;
use serde::{Deserialize, Serialize};

/// Seconds in a millisecond.
const MS: f64 = 1e-3;

/// Something that a real skin or its reader does to a signal; zero strength is none of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Imperfection {
    /// Loading and unloading read differently.
    Hysteresis,
    /// Values leak to the neighbours.
    Crosstalk,
    /// Each taxel has its own gain.
    Gain,
    /// Each taxel's zero wanders.
    Drift,
    /// Taxels read 0.
    Dead,
    /// Taxels read a level of their own.
    Stuck,
    /// Taxels are read one after another.
    Scan,
    /// A converter clips and rounds.
    Quantisation,
}

/// Every imperfection, in the order in which tables show them: the material first, the electronics last.
pub const IMPERFECTIONS: [Imperfection; 8] = [
    Imperfection::Hysteresis,
    Imperfection::Crosstalk,
    Imperfection::Gain,
    Imperfection::Drift,
    Imperfection::Dead,
    Imperfection::Stuck,
    Imperfection::Scan,
    Imperfection::Quantisation,
];

/// The skin that tells whether a classifier has learned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TestedOn {
    /// The skin that trained it: what is peculiar to the skin may be learned.
    #[default]
    SameSkin,
    /// Another of the same make, each trial a new one: gains, drift and faults are drawn anew.
    AnotherSkin,
}

/// A strength for each imperfection, in the unit of its key; `None` for those that a study does not have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Strengths([Option<f64>; IMPERFECTIONS.len()]);

impl Imperfection {
    /// The key of `[signal]` and the column of the tables.
    pub fn key(self) -> &'static str {
        match self {
            Self::Hysteresis => "hysteresis_full_scale",
            Self::Crosstalk => "crosstalk",
            Self::Gain => "gain_std",
            Self::Drift => "drift_std_full_scale",
            Self::Dead => "dead_fraction",
            Self::Stuck => "stuck_fraction",
            Self::Scan => "scan_time_ms",
            Self::Quantisation => "adc_bits",
        }
    }

    /// The name in a sentence or before a value.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hysteresis => "hysteresis",
            Self::Crosstalk => "crosstalk",
            Self::Gain => "gain mismatch",
            Self::Drift => "drift",
            Self::Dead => "dead taxels",
            Self::Stuck => "stuck taxels",
            Self::Scan => "scan time",
            Self::Quantisation => "converter",
        }
    }

    /// A strength as people write it, with its unit: `20 %`, `8 bits`, `none`.
    pub fn describe(self, strength: f64) -> String {
        // 100 × 0.07 is not 7 in floating point.
        let percent = (strength * 1e8).round() / 1e6;
        match self {
            Self::Quantisation if strength == 0.0 => "none".to_owned(),
            Self::Quantisation if strength == 1.0 => "1 bit".to_owned(),
            Self::Quantisation => format!("{strength} bits"),
            Self::Scan => format!("{strength} ms"),
            _ => format!("{percent} %"),
        }
    }

    /// The step of the signal that does it.
    pub(super) fn step(self) -> StepSpec {
        match self {
            Self::Hysteresis => StepSpec::Hysteresis,
            Self::Crosstalk => StepSpec::Crosstalk,
            Self::Gain => StepSpec::Gain,
            Self::Drift => StepSpec::Drift,
            Self::Dead | Self::Stuck => StepSpec::Faults,
            Self::Scan => StepSpec::Scan,
            Self::Quantisation => StepSpec::Quantisation,
        }
    }

    /// Its axis, as a study gives it.
    pub(super) fn axis(self, signal: &SignalSpec) -> Option<&Axis<f64>> {
        let axis = match self {
            Self::Hysteresis => &signal.hysteresis_full_scale,
            Self::Crosstalk => &signal.crosstalk,
            Self::Gain => &signal.gain_std,
            Self::Drift => &signal.drift_std_full_scale,
            Self::Dead => &signal.dead_fraction,
            Self::Stuck => &signal.stuck_fraction,
            Self::Scan => &signal.scan_time_ms,
            Self::Quantisation => &signal.adc_bits,
        };
        axis.as_ref()
    }

    /// Whether a strength is possible, and in words what is.
    pub(super) fn range(self) -> (fn(f64) -> bool, &'static str) {
        match self {
            Self::Gain => (super::check::not_negative, "zero or a positive number"),
            Self::Drift => (
                super::check::not_negative,
                "zero or a positive fraction of the full scale",
            ),
            Self::Scan => (
                super::check::not_negative,
                "zero or a positive number of milliseconds",
            ),
            Self::Hysteresis => (
                |w| (0.0..=0.25).contains(&w),
                "a fraction of the full scale, 0 to 0.25",
            ),
            Self::Crosstalk | Self::Dead | Self::Stuck => {
                (|f| (0.0..=1.0).contains(&f), "a fraction, 0 to 1")
            }
            Self::Quantisation => (
                |bits| bits.fract() == 0.0 && (0.0..=24.0).contains(&bits),
                "a whole number of bits, 1 to 24, or 0 for no converter",
            ),
        }
    }
}

impl Strengths {
    /// The strength of an imperfection; `None` if the study does not have it.
    pub fn of(&self, imperfection: Imperfection) -> Option<f64> {
        self.0[imperfection as usize]
    }

    /// These with another strength for one of them.
    pub fn with(mut self, imperfection: Imperfection, strength: Option<f64>) -> Self {
        self.0[imperfection as usize] = strength;
        self
    }

    /// The imperfections that are there, with their strengths.
    pub fn present(&self) -> impl Iterator<Item = (Imperfection, f64)> {
        let strengths = IMPERFECTIONS.into_iter().zip(self.0);
        strengths.filter_map(|(imperfection, strength)| {
            let strength = strength.filter(|&s| s != 0.0)?;
            Some((imperfection, strength))
        })
    }

    /// The signal's step of a name at these strengths; none for a step that is no imperfection.
    pub(super) fn signal_step(&self, step: StepSpec, skin: &Seed) -> Option<SignalStep> {
        let strength = |imperfection| self.of(imperfection).unwrap_or(0.0);
        let skin = *skin;
        Some(match step {
            StepSpec::Force | StepSpec::Noise | StepSpec::Smoothing => return None,
            StepSpec::Hysteresis => SignalStep::Hysteresis {
                width: strength(Imperfection::Hysteresis),
            },
            StepSpec::Crosstalk => SignalStep::Crosstalk {
                leak: strength(Imperfection::Crosstalk),
            },
            StepSpec::Gain => SignalStep::Gain(GainMismatch {
                std: strength(Imperfection::Gain),
                skin,
            }),
            StepSpec::Drift => SignalStep::Drift(Drift {
                std: strength(Imperfection::Drift),
                skin,
            }),
            StepSpec::Faults => SignalStep::Faults(Faults {
                dead: strength(Imperfection::Dead),
                stuck: strength(Imperfection::Stuck),
                skin,
            }),
            StepSpec::Scan => SignalStep::Scan {
                seconds: strength(Imperfection::Scan) * MS,
            },
            StepSpec::Quantisation => SignalStep::Quantisation {
                bits: strength(Imperfection::Quantisation) as u32,
            },
        })
    }
}

/// The skin of a study's array: the same in each touch and trial.
pub(super) fn skin(study: &Seed, grid: &Grid) -> Seed {
    let sides = [grid.nx as u64, grid.ny as u64];
    let named = sides
        .iter()
        .fold(study.named("skin"), |seed, &n| seed.numbered(n));
    named.numbered(grid.pitch.to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_imperfection_stands_in_the_place_of_its_number() {
        for (place, imperfection) in IMPERFECTIONS.into_iter().enumerate() {
            assert_eq!(imperfection as usize, place);
            let strengths = Strengths::default().with(imperfection, Some(0.5));
            assert_eq!(strengths.of(imperfection), Some(0.5));
            assert_eq!(
                strengths.present().collect::<Vec<_>>(),
                [(imperfection, 0.5)]
            );
            let none = strengths.with(imperfection, Some(0.0));
            assert_eq!(none.present().count(), 0);
        }
    }

    #[test]
    fn strengths_are_told_with_their_units() {
        let told = [
            (Imperfection::Gain, 0.07, "7 %"),
            (Imperfection::Quantisation, 8.0, "8 bits"),
            (Imperfection::Quantisation, 1.0, "1 bit"),
            (Imperfection::Quantisation, 0.0, "none"),
            (Imperfection::Scan, 12.5, "12.5 ms"),
        ];
        for (imperfection, strength, words) in told {
            assert_eq!(imperfection.describe(strength), words);
        }
    }
}
