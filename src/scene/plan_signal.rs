//! What a patch's electronics make of what it feels: steps from deflections or forces to a signal, checked.

use super::frame::PatchReading;
use super::reader::{MM, Reader};
use super::spec::SignalStepSpec;
use crate::error::Result;
use crate::random::Seed;
use crate::signal::{
    Chain, MOST_STRENGTHS, Noise, Quantity, Recording, SENSOR_ERRORS, Scratch, SignalStep, Strength,
};
use crate::spelling::nearest_names;
use crate::study::{NOISES, not_negative};
use crate::world::Patch;

/// The key of smoothing, beside those of [noise](NOISES) and of sensor errors.
const SMOOTHING: &str = "smoothing_mm";

/// The signal of a patch, ready to be read.
#[derive(Clone, Debug)]
pub struct PlannedSignal {
    chain: Chain,
    /// What it begins with.
    begins: Quantity,
}

impl PlannedSignal {
    /// What its values are.
    pub fn quantity(&self) -> Quantity {
        self.chain.quantity()
    }

    /// Reads what a patch feels, its noise of this name, at a share of the scene's time.
    pub(super) fn read(
        &self,
        reading: &mut PatchReading,
        name: &Seed,
        share: f64,
        scratch: &mut Scratch,
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
    /// Of a patch that has steps.
    pub fn signal(
        &self,
        key: &str,
        steps: &[SignalStepSpec],
        skin: &Patch,
        seed: &Seed,
    ) -> Result<Option<PlannedSignal>> {
        let Some(first) = steps.first() else {
            return Ok(None);
        };
        let key = &format!("{key}.signal");
        let is_force = |step: &SignalStepSpec| matches!(step, SignalStepSpec::Word(_));
        let begins = match is_force(first) {
            true => Quantity::Force,
            false => Quantity::Deflection,
        };
        for (place, step) in steps.iter().enumerate() {
            let SignalStepSpec::Word(word) = step else {
                continue;
            };
            if word != "force" || place > 0 {
                let given = format!("{word:?} as step {}", place + 1);
                let allowed = "\"force\" as the first, and steps such as { noise_std_n = 0.1 }";
                return Err(self.check.error(key, given, allowed));
            }
        }
        let owner = seed.named("skin").named(skin.name());
        let steps = steps.iter().filter(|step| !is_force(step));
        let steps = steps.map(|step| self.signal_step(key, step, owner));
        let steps = steps.collect::<Result<Vec<_>>>()?;
        Ok(Some(PlannedSignal {
            chain: self.under(key, Chain::of(&steps, skin, begins))?,
            begins,
        }))
    }

    fn signal_step(&self, key: &str, step: &SignalStepSpec, skin: Seed) -> Result<SignalStep> {
        let SignalStepSpec::Strengths(given) = step else {
            unreachable!("words are no steps of the chain");
        };
        let Some((first, &value)) = given.first_key_value() else {
            let allowed = "one step's keys: { noise_std_n = 0.1 }";
            return Err(self.check.error(key, "a step without a key", allowed));
        };
        let noise = NOISES.iter().find(|(name, _)| name == first);
        if noise.is_some() || first == SMOOTHING {
            let key = &format!("{key}.{first}");
            if given.len() > 1 {
                let said = "another key beside it";
                return Err(self.check.error(key, said, "one step in each { }"));
            }
            let value = self
                .check
                .value(key, value, not_negative, "zero or a positive number")?;
            return Ok(match noise {
                Some(&(_, unit)) => SignalStep::Noise(Noise { std: value, unit }),
                None => SignalStep::Smoothing { width: value * MM },
            });
        }
        let has = |name| move |strength: &Strength| strength.key == name;
        let found = SENSOR_ERRORS.iter().find(|error| {
            let mut strengths = error.about().strengths.iter();
            strengths.any(has(first.as_str()))
        });
        let Some(error) = found else {
            let strengths = SENSOR_ERRORS
                .iter()
                .flat_map(|error| error.about().strengths);
            let errors = strengths.map(|strength| strength.key);
            let noises = NOISES.iter().map(|(name, _)| *name);
            let names = noises.chain([SMOOTHING]).chain(errors);
            let given = format!("`{first}`");
            return Err(self.check.error(key, given, nearest_names(first, names)));
        };
        let about = error.about();
        if about.remembers || about.needs_motion {
            let given = format!("`{first}`, which needs the frames before and after");
            let allowed = "steps that read each frame alone (studies have all)";
            return Err(self.check.error(key, given, allowed));
        }
        let mut strengths = [0.0; MOST_STRENGTHS];
        for (name, &value) in given {
            let Some(place) = about.strengths.iter().position(has(name.as_str())) else {
                let given = format!("`{name}` beside `{first}`");
                return Err(self.check.error(key, given, "one step in each { }"));
            };
            let strength = &about.strengths[place];
            let key = &format!("{key}.{name}");
            strengths[place] =
                self.check
                    .value(key, value, strength.is_allowed, strength.allowed)?;
        }
        Ok(SignalStep::Error {
            error: *error,
            strengths,
            skin,
        })
    }
}
