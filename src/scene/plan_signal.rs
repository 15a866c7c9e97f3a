//! Signal chain of a patch with checked steps; it converts deflections or forces to sensor output.

use super::frame::PatchReading;
use super::reader::Reader;
use super::spec::SignalStepSpec;
use crate::error::Result;
use crate::inputs::range::Range;
use crate::inputs::sensor_errors::{NOISES, noise_words, strength_words};
use crate::inputs::units::MM;
use crate::random::Seed;
use crate::signal::{
    Chain, Noise, NoiseUnit, Quantity, Recording, SensorError, SignalStep, SignalWorkspace,
};
use crate::spelling::nearest_names;
use crate::world::Patch;
use std::collections::BTreeMap;

/// Kind of step in the signal chain of a patch.
enum StepKind {
    /// Noise, with its key and its unit.
    Noise(&'static str, NoiseUnit),
    Smoothing,
    Error(SensorError),
}

/// Key of a step of a signal chain.
pub(super) struct StepKey {
    /// Name of the key.
    pub name: &'static str,
    /// Meaning of its number.
    pub words: String,
    range: Range,
}

impl StepKind {
    /// Returns all kinds of steps: noises, smoothing, and sensor errors.
    fn all() -> impl Iterator<Item = Self> {
        let noises = NOISES.map(|(name, unit)| Self::Noise(name, unit));
        let errors = SensorError::all().map(Self::Error);
        let simple = noises.into_iter().chain([Self::Smoothing]);
        simple.chain(errors)
    }

    /// Returns whether the step reads each frame alone; a scene has no other steps.
    fn is_of_single_frames(&self) -> bool {
        match self {
            Self::Noise(..) | Self::Smoothing => true,
            Self::Error(error) => error.about().is_of_single_frames(),
        }
    }

    /// Returns the keys of the step.
    fn keys(&self) -> Vec<StepKey> {
        let one = |name, words| {
            let range = Range::NotNegative;
            vec![StepKey { name, words, range }]
        };
        match *self {
            Self::Noise(name, unit) => one(name, noise_words(unit)),
            Self::Smoothing => {
                let words = "Standard deviation of the Gaussian smoothing over the array, mm.";
                one("smoothing_mm", words.to_owned())
            }
            Self::Error(error) => {
                let strengths = error.about().strengths.iter();
                let keys = strengths.map(|strength| StepKey {
                    name: strength.key,
                    words: strength_words(error, strength),
                    range: Range::Strength(strength),
                });
                keys.collect()
            }
        }
    }
}

/// Returns the keys of all steps that a patch of a scene allows.
pub(super) fn step_keys() -> impl Iterator<Item = StepKey> {
    let kinds = StepKind::all().filter(StepKind::is_of_single_frames);
    kinds.flat_map(|kind| kind.keys())
}

/// Checked signal chain of a patch, which converts deflections to sensor readings.
#[derive(Clone, Debug)]
pub struct PlannedSignal {
    chain: Chain,
    /// Physical quantity that enters the signal chain: deflection or force.
    begins: Quantity,
}

impl PlannedSignal {
    /// Returns the physical quantity of the sensor readings: deflection or force.
    pub fn quantity(&self) -> Quantity {
        self.chain.quantity()
    }

    /// Computes the sensor readings of a patch and writes them to `reading`. The seed of the noise is `name`; `share` is the elapsed fraction of the scene's
    /// duration, 0 to 1.
    pub(super) fn read(
        &self,
        reading: &mut PatchReading,
        name: &Seed,
        share: f64,
        scratch: &mut SignalWorkspace,
    ) {
        let felt = match self.begins {
            Quantity::Deflection => &reading.deflection,
            Quantity::Force => &reading.force,
        };
        let signal = reading.signal.get_or_insert_default();
        signal.clone_from(felt);
        let recording = Recording {
            frames: signal,
            rates: None,
            n_before: 0,
            interval: None,
            time: Some(share),
        };
        self.chain.apply_recording(recording, name, scratch);
    }
}

impl Reader<'_> {
    /// Checks the signal steps of a patch and returns its signal chain; `None` if there are no steps.
    pub fn signal(
        &self,
        key: &str,
        steps: &[SignalStepSpec],
        skin: &Patch,
        seed: &Seed,
    ) -> Result<Option<PlannedSignal>> {
        let key = &format!("{key}.signal");
        let (begins, rest) = match steps {
            [] => return Ok(None),
            [SignalStepSpec::Word(word), rest @ ..] if word == "force" => (Quantity::Force, rest),
            _ => (Quantity::Deflection, steps),
        };
        let owner = seed.named("skin").named(skin.name());
        let first = 1 + steps.len() - rest.len();
        let steps = rest.iter().zip(first..).map(|(step, place)| match step {
            SignalStepSpec::Strengths(given) => self.signal_step(key, given, owner),
            SignalStepSpec::Word(word) => {
                let given = format!("{word:?} as step {place}");
                let allowed = "\"force\" as the first, and steps such as { noise_std_n = 0.1 }";
                self.refuse(key, given, allowed)
            }
        });
        let steps = steps.collect::<Result<Vec<_>>>()?;
        Ok(Some(PlannedSignal {
            chain: self.under(key, Chain::with_quantity(&steps, skin, begins))?,
            begins,
        }))
    }

    fn signal_step(
        &self,
        key: &str,
        given: &BTreeMap<String, f64>,
        skin: Seed,
    ) -> Result<SignalStep> {
        let Some(first) = given.keys().next() else {
            let allowed = "one step's keys: { noise_std_n = 0.1 }";
            return self.refuse(key, "a step without a key", allowed);
        };
        let mut kinds = StepKind::all().map(|kind| (kind.keys(), kind));
        let found = kinds.find(|(keys, _)| keys.iter().any(|key| key.name == first));
        let Some((keys, kind)) = found else {
            let names = StepKind::all().flat_map(|kind| kind.keys());
            let offered = nearest_names(first, names.map(|key| key.name));
            return self.refuse(key, format!("`{first}`"), offered);
        };
        if !kind.is_of_single_frames() {
            let given = format!("`{first}`, which needs the frames before and after");
            let allowed = "steps that read each frame alone (studies have all)";
            return self.refuse(key, given, allowed);
        }
        let mut values = vec![0.0; keys.len()];
        for (name, &value) in given {
            let Some(place) = keys.iter().position(|key| key.name == name) else {
                let given = format!("`{name}` beside `{first}`");
                return self.refuse(key, given, "one step in each { }");
            };
            let range = keys[place].range;
            if !range.contains(value) {
                return self.refuse(&format!("{key}.{name}"), value, range.words());
            }
            values[place] = value;
        }
        match kind {
            StepKind::Noise(_, unit) => Ok(SignalStep::Noise(Noise {
                std: values[0],
                unit,
            })),
            StepKind::Smoothing => Ok(SignalStep::Smoothing {
                width: values[0] * MM,
            }),
            StepKind::Error(error) => error.step(&values, skin),
        }
    }
}
