//! Description of a sensor error: its signal step, strengths, dependencies and constructor.

use super::taxel_effect::TaxelEffect;
use crate::error::{Error, Result};
use crate::random::{CounterKey, Seed};
use crate::world::Patch;
use std::fmt::Debug;

/// Strength parameter of a sensor error; zero disables the error.
#[derive(Debug)]
pub struct Strength {
    /// Key of the strength in the table `[signal]` of a study, and name of the column in result tables.
    pub key: &'static str,
    /// Display name of the strength, written before a value, such as `gain mismatch`.
    pub words: &'static str,
    /// Unit of the strength, such as `ms`; `%` for a fraction.
    pub unit: &'static str,
    /// Whether the strength must be an integer.
    pub is_whole: bool,
    /// Smallest and largest allowed value of the strength.
    pub range: [f64; 2],
    /// Allowed values of the strength, in words.
    pub allowed: &'static str,
    /// Special values of the strength with their names, such as `0` and `none`.
    pub names: &'static [(&'static str, &'static str)],
}

/// Constructor of a sensor error. The function prepares the effect for a skin; the strengths are allowed, and at least one of them is nonzero.
pub type Prepare = fn(&[f64; MAX_STRENGTHS], &Skin) -> Result<Box<dyn Effect>>;

/// Constructor of a sensor error for the taxels of a whole body. Its arguments are allowed strengths (at least one of them nonzero), the full scale in metres
/// or newtons, and the key of the random draws.
pub type PrepareByTaxel = fn(&[f64; MAX_STRENGTHS], f64, CounterKey) -> TaxelEffect;

/// Description of a sensor error: strengths, dependencies, and constructors.
#[derive(Debug)]
pub struct ErrorAbout {
    /// Name of the sensor error in the list `signal.steps` of a study.
    pub step: &'static str,
    /// Strength parameters of the sensor error: one, or [two](MAX_STRENGTHS) fractions whose sum is at most 1.
    pub strengths: &'static [Strength],
    /// Whether the sensor error is a fixed property of a skin; another skin of the same type has different random values.
    pub is_of_skin: bool,
    /// Whether repeated readings of one touch on one skin differ because of the error.
    pub is_random_by_reading: bool,
    /// Whether the readings of a touch depend on the touches before it.
    pub remembers: bool,
    /// Whether the errors of one frame of a touch depend on the other frames.
    pub spans_frames: bool,
    /// Whether the sensor error has an effect only if frames are read while the press moves.
    pub needs_motion: bool,
    /// Whether the sensor error depends on the positions of the taxels: on their neighbours, or on rows and columns.
    pub needs_places: bool,
    /// Constructor of the error for whole frames.
    pub prepare: Prepare,
    /// Constructor of the error for a `BodyReadout`; `None` if the error depends on other taxels or on other frames.
    pub by_taxel: Option<PrepareByTaxel>,
}

/// Maximum number of strength parameters of a sensor error.
pub const MAX_STRENGTHS: usize = 2;

/// Skin for which a sensor error is prepared, with its full scale and seed.
#[derive(Clone, Copy, Debug)]
pub struct Skin<'a> {
    /// Patch of the skin.
    pub patch: &'a Patch,
    /// Value of a taxel at the end of its stroke, metres or newtons.
    pub full_scale: f64,
    /// Lowest possible reading: zero, or minus the full scale if values have a sign.
    pub least: f64,
    /// Seed of this specimen of the skin, constant over all touches.
    pub name: Seed,
}

/// Prepared sensor error or smoothing, applied to frames.
pub trait Effect: Debug + Send + Sync {
    /// Returns the number of scratch values that `apply` needs.
    fn scratch_len(&self) -> usize {
        0
    }

    /// Returns whether the readings of a touch depend on the frames before it.
    fn remembers(&self) -> bool {
        false
    }

    /// Applies the effect to frames of n_taxels values each, in the order of time, without allocating memory. By default, each frame is read by itself.
    fn apply(&self, frames: &mut [f64], touch: &TouchRead, scratch: &mut [f64]) {
        for frame in frames.chunks_exact_mut(touch.n_taxels) {
            self.apply_to_frame(frame, scratch);
        }
    }

    /// Applies an effect that needs neither other frames nor the touch to one frame. Effects that implement `apply` do not use this function.
    fn apply_to_frame(&self, _: &mut [f64], _: &mut [f64]) {}
}

/// Metadata of a touch that affect the readings of its frames.
#[derive(Clone, Copy, Debug)]
pub struct TouchRead<'a> {
    /// Number of values in a frame.
    pub n_taxels: usize,
    /// Rates of deflection δ̇, m/s, one per value of the frames; `None` if the patch does not move.
    pub rates: Option<&'a [f64]>,
    /// Number of leading frames recorded before the touch.
    pub n_before: usize,
    /// Time between frames, seconds; `None` if the press stops at each frame until all taxels are read.
    pub interval: Option<f64>,
    /// Time of the touch, as a fraction of the recording session from 0 to 1; if `None`, the time is random and depends on `seed`.
    pub time: Option<f64>,
    /// Seed of the touch.
    pub seed: &'a Seed,
}

/// Two strength parameters are equal if their keys are equal.
impl PartialEq for Strength {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}

impl ErrorAbout {
    /// Describes a sensor error with default properties: not a property of a skin, not random between readings, and independent of earlier touches.
    pub const fn new(step: &'static str, strengths: &'static [Strength], prepare: Prepare) -> Self {
        Self {
            step,
            strengths,
            is_of_skin: false,
            is_random_by_reading: false,
            remembers: false,
            spans_frames: false,
            needs_motion: false,
            needs_places: false,
            prepare,
            by_taxel: None,
        }
    }

    /// Checks the values of the strengths.
    ///
    /// # Errors
    /// If a value is not allowed, or the sum of two fractions exceeds 1.
    pub(super) fn check(&self, values: &[f64; MAX_STRENGTHS]) -> Result<()> {
        for (strength, &value) in self.strengths.iter().zip(values) {
            if !strength.is_allowed(value) {
                return Err(Error::input(strength.key, value, strength.allowed));
            }
        }
        if let ([first, second], [a, b]) = (self.strengths, values)
            && a + b > 1.0
        {
            let keys = format!("{} and {}", first.key, second.key);
            return Err(Error::input(
                keys,
                format!("{a} and {b}"),
                "at most 1 together",
            ));
        }
        Ok(())
    }

    /// Returns whether the error of each frame of a touch is independent of the other frames.
    pub fn is_of_single_frames(&self) -> bool {
        !(self.remembers || self.spans_frames || self.needs_motion)
    }
}

impl Strength {
    /// Returns whether a value of the strength is allowed.
    pub fn is_allowed(&self, value: f64) -> bool {
        (self.range[0]..=self.range[1]).contains(&value) && !(self.is_whole && value.fract() != 0.0)
    }

    /// Describes a strength that is a fraction from 0 to 1, with its key and its display name.
    pub const fn fraction(key: &'static str, words: &'static str) -> Self {
        Self {
            key,
            words,
            unit: "%",
            is_whole: false,
            range: [0.0, 1.0],
            allowed: "a fraction, 0 to 1",
            names: &[],
        }
    }

    /// Describes a strength that is a fraction without an upper bound, with its key, its display name and the allowed values in words.
    pub const fn share(key: &'static str, words: &'static str, allowed: &'static str) -> Self {
        Self {
            range: [0.0, f64::MAX],
            allowed,
            ..Self::fraction(key, words)
        }
    }
}

/// Declares the sensor errors and the module of each error; their order is the order of the table columns.
macro_rules! sensor_errors {
    ($($name:ident $file:ident $doc:literal;)*) => {
        $(mod $file;)*

        /// Sensor errors of real skins and their electronics.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum SensorError {
            $(#[doc = $doc] $name,)*
            /// Sensor error from outside of this crate; see [`register`](Self::register).
            Own(crate::own::Own<ErrorAbout>),
        }

        /// List of all sensor errors of this crate; [`SensorError::all`] also returns registered ones.
        pub const SENSOR_ERRORS: &[SensorError] = &[$(SensorError::$name),*];

        impl SensorError {
            /// Returns the description of the sensor error.
            pub const fn about(self) -> &'static ErrorAbout {
                match self {
                    $(Self::$name => &$file::ABOUT,)*
                    Self::Own(own) => own.about(),
                }
            }
        }
    };
}
