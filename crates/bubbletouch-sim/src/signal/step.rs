//! Steps of a signal chain.

use super::{ErrorAbout, MAX_STRENGTHS, Noise, SENSOR_ERRORS, SensorError};
use crate::error::{Error, Result};
use crate::own::Registry;
use crate::random::Seed;

/// Sensor errors that a program has registered.
static OWN: Registry<ErrorAbout> = Registry::new("sensor error");

/// Maximum number of strengths of all registered sensor errors together. A larger value makes each signal condition of a study larger.
pub const MAX_OWN_STRENGTHS: usize = 8;

/// Words of the table `[signal]` of a study that belong to no sensor error.
const RESERVED: [&str; 10] = [
    "force",
    "noise",
    "smoothing",
    "noise_std_full_scale",
    "noise_std_mm",
    "noise_std_n",
    "smoothing_mm",
    "steps",
    "test_sensor",
    "combine",
];

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
    /// Registers a sensor error from outside of this crate, before the first study is read. The name of its step and the keys of its strengths are then used in
    /// studies and scenes like those of a built-in error; the step is written as `name@version`.
    ///
    /// ```
    /// use bubbletouch_sim::random::Seed;
    /// use bubbletouch_sim::signal::{
    ///     Chain, Effect, ErrorAbout, SensorError, SignalWorkspace, Strength, TouchRead,
    /// };
    /// use bubbletouch_sim::world::{Grid, Patch, Taxel};
    ///
    /// /// Every taxel reads too much by a fraction.
    /// #[derive(Debug)]
    /// struct TooMuch(f64);
    ///
    /// impl Effect for TooMuch {
    ///     fn apply(&self, frames: &mut [f64], _: &TouchRead, _: &mut [f64]) {
    ///         frames.iter_mut().for_each(|value| *value *= 1.0 + self.0);
    ///     }
    /// }
    ///
    /// const SHARE: &[Strength] = &[Strength::fraction("too_much_share", "excess")];
    /// let about = ErrorAbout::new("too_much", SHARE, |&[share, _], _| Ok(Box::new(TooMuch(share))));
    /// let too_much = SensorError::register("1", about)?;
    ///
    /// let grid = Grid { nx: 2, ny: 1, pitch: 2e-3 };
    /// let taxel = Taxel { radius: 1e-3, stiffness: 200.0, damping: 0.0, stroke: 5e-3 };
    /// let seed = Seed::new(2018);
    /// let chain = Chain::new(&[too_much.step(&[0.5], seed)?], &Patch::grid(grid, taxel)?)?;
    /// let mut frame = vec![2e-3, 0.0];
    /// chain.apply(&mut frame, None, &seed, &mut SignalWorkspace::default());
    /// assert_eq!(frame, [3e-3, 0.0]);
    /// # Ok::<(), bubbletouch_sim::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the name or a key is taken or invalid, or a study was read before. Also if the error does not have 1 to [`MAX_STRENGTHS`] strengths, or all registered
    /// errors have more than [`MAX_OWN_STRENGTHS`] strengths.
    pub fn register(version: &'static str, about: ErrorAbout) -> Result<Self> {
        let (name, strengths) = (about.step, about.strengths);
        let given = format!("{} strengths", strengths.len());
        if !(1..=MAX_STRENGTHS).contains(&strengths.len()) {
            let allowed = format!("1 to {MAX_STRENGTHS}");
            return Err(Error::input(format!("sensor error {name}"), given, allowed));
        }
        let registered = OWN.registered();
        let n_own: usize = registered
            .iter()
            .map(|own| own.about().strengths.len())
            .sum();
        if n_own + strengths.len() > MAX_OWN_STRENGTHS {
            let given = format!("{given} beside {n_own}");
            let allowed = format!("{MAX_OWN_STRENGTHS} strengths of all registered errors");
            return Err(Error::input(format!("sensor error {name}"), given, allowed));
        }
        let words = |about: &'static ErrorAbout| {
            let keys = about.strengths.iter().map(|one| one.key);
            keys.chain([about.step])
        };
        let built_in = SENSOR_ERRORS.iter().map(|error| error.about());
        let others = built_in.chain(registered.iter().map(|own| own.about()));
        let taken: Vec<&str> = others.flat_map(words).chain(RESERVED).collect();
        let keys = strengths.iter().map(|one| one.key);
        let own: Vec<&str> = keys.chain([name]).collect();
        let is_taken = own
            .iter()
            .enumerate()
            .any(|(place, word)| taken.contains(word) || own[..place].contains(word));
        OWN.register(name, version, about, is_taken).map(Self::Own)
    }

    /// Returns all sensor errors, from the material to the electronics; those that the program has registered are last.
    pub fn all() -> impl Iterator<Item = Self> + Clone {
        let own = OWN.all().iter().map(|own| Self::Own(*own));
        SENSOR_ERRORS.iter().copied().chain(own)
    }

    /// Returns the name of the signal step in the files of studies: `name@version` for a registered error.
    pub fn text(self) -> String {
        match self {
            Self::Own(own) => own.to_string(),
            _ => self.about().step.to_owned(),
        }
    }

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

    /// Returns the sensor error whose signal step has the name `word`, or `name@version` if it is registered; `None` if there is none.
    pub fn of_step(word: &str) -> Option<Self> {
        Self::all().find(|error| error.about().step == word || error.text() == word)
    }
}

/// Returns the seed of a repeated sensor error, which draws its own numbers; the first step of an error has the given seed.
pub(super) fn seed_of_repetition(seed: &Seed, repetition: u64) -> Seed {
    match repetition {
        0 => *seed,
        n => seed.named("repetition").numbered(n),
    }
}
