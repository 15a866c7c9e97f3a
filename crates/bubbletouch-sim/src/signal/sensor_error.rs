//! What a sensor error says of itself: its step, its strengths, what it belongs to, what it costs, and how it is made.

use super::taxel_effect::TaxelEffect;
use crate::error::Result;
use crate::random::{CounterKey, Seed};
use crate::world::Patch;
use std::fmt::Debug;

/// A number that says how strong a sensor error is; zero is none of it.
#[derive(Debug)]
pub struct Strength {
    /// The key of `[signal]` and the column of tables.
    pub key: &'static str,
    /// What people call it, before a value: `gain mismatch`.
    pub words: &'static str,
    /// Of the value: `ms`; `%` of a share of one.
    pub unit: &'static str,
    /// Whether it is a whole number.
    pub is_whole: bool,
    /// Whether a value is possible.
    pub is_allowed: fn(f64) -> bool,
    /// What is, in words.
    pub allowed: &'static str,
    /// What people call values that are more than numbers: `0`, `none`.
    pub names: &'static [(&'static str, &'static str)],
}

/// Checks strengths of which at least one is not zero, and prepares what they do to the signal of a skin.
pub type Prepare = fn(&[f64; MAX_STRENGTHS], &Skin) -> Result<Box<dyn Effect>>;

/// Prepares an error for the taxels of a whole body, from allowed strengths of which at least one is not zero, the full scale (metres or
/// newtons) and the key of its draws.
pub type PrepareByTaxel =
    fn(&[f64; MAX_STRENGTHS], f64, CounterKey) -> Result<Box<dyn TaxelEffect>>;

/// A sensor error.
#[derive(Debug)]
pub struct ErrorAbout {
    /// The word of `signal.steps`.
    pub step: &'static str,
    /// How strong it is: one number, or [two](MAX_STRENGTHS), shares of one whole that are at most 1 together.
    pub strengths: &'static [Strength],
    /// Whether it belongs to a skin: another skin of the same make has another of it.
    pub is_of_skin: bool,
    /// Whether two readings of one touch on one skin differ.
    pub is_random_by_reading: bool,
    /// Whether what a touch reads depends on the touches before it.
    pub remembers: bool,
    /// Whether it shows only in frames that the press moves through.
    pub needs_motion: bool,
    /// Whether the error depends on where the taxels are: on their neighbours, or on rows and columns.
    pub needs_places: bool,
    /// Checks strengths of which at least one is not zero, and prepares what they do.
    pub prepare: Prepare,
    /// Prepares the error for a [`BodyReadout`](super::BodyReadout); `None` if it depends on other taxels or on other frames.
    pub by_taxel: Option<PrepareByTaxel>,
}

/// Strengths of an error, at most.
pub const MAX_STRENGTHS: usize = 2;

/// Whose signal it is.
#[derive(Clone, Copy, Debug)]
pub struct Skin<'a> {
    /// Its taxels.
    pub patch: &'a Patch,
    /// The value of a taxel at its stroke: metres, or newtons.
    pub full_scale: f64,
    /// The least value that it reads: zero, or minus the full scale of values that have a sign.
    pub least: f64,
    /// The name of the piece of hardware, the same in each touch.
    pub name: Seed,
}

/// What a prepared error does to frames.
pub trait Effect: Debug + Send + Sync {
    /// Numbers of working memory that [`apply`](Self::apply) needs.
    fn scratch_len(&self) -> usize {
        0
    }

    /// Changes frames of n_taxels values each, one after the other in time. Nothing is allocated.
    fn apply(&self, frames: &mut [f64], touch: &TouchRead, scratch: &mut [f64]);
}

/// How the frames of a touch are read.
#[derive(Clone, Copy, Debug)]
pub struct TouchRead<'a> {
    /// Values of a frame.
    pub n_taxels: usize,
    /// Leading frames that came before the touch.
    pub n_before: usize,
    /// Seconds between frames; `None` when the press waits at each until it is read.
    pub interval: Option<f64>,
    /// The share of the session that has gone, 0 to 1; `None` when the touch's name decides.
    pub time: Option<f64>,
    /// The touch's own name.
    pub seed: &'a Seed,
}

/// Their keys tell them apart.
impl PartialEq for Strength {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}

impl ErrorAbout {
    /// Describes an error of a light cost that belongs to no skin, reads a touch the same way each time, and remembers nothing.
    pub(super) const fn new(
        step: &'static str,
        strengths: &'static [Strength],
        prepare: Prepare,
    ) -> Self {
        Self {
            step,
            strengths,
            is_of_skin: false,
            is_random_by_reading: false,
            remembers: false,
            needs_motion: false,
            needs_places: false,
            prepare,
            by_taxel: None,
        }
    }
}

impl Strength {
    /// A fraction of something, from 0 to 1.
    pub(super) const fn fraction(key: &'static str, words: &'static str) -> Self {
        Self {
            key,
            words,
            unit: "%",
            is_whole: false,
            is_allowed: |share| (0.0..=1.0).contains(&share),
            allowed: "a fraction, 0 to 1",
            names: &[],
        }
    }

    /// A share of one without an end.
    pub(super) const fn share(
        key: &'static str,
        words: &'static str,
        allowed: &'static str,
    ) -> Self {
        Self {
            is_allowed: |share| share.is_finite() && share >= 0.0,
            allowed,
            ..Self::fraction(key, words)
        }
    }
}

/// Says of each sensor error which file tells of it; the order is that of the tables' columns.
macro_rules! sensor_errors {
    ($($name:ident $file:ident $doc:literal;)*) => {
        $(mod $file;)*

        /// What real skins and their readers do to a signal.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum SensorError {
            $(#[doc = $doc] $name,)*
        }

        /// All of them.
        pub const SENSOR_ERRORS: &[SensorError] = &[$(SensorError::$name),*];

        impl SensorError {
            /// What it says of itself.
            pub const fn about(self) -> &'static ErrorAbout {
                match self {
                    $(Self::$name => &$file::ABOUT,)*
                }
            }
        }
    };
}
