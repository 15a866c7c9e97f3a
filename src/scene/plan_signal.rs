//! Signal chain of a patch with checked steps; it converts deflections or forces to sensor output.

use super::frame::PatchReading;
use super::reader::{MM, Reader};
use super::spec::SignalStepSpec;
use crate::error::Result;
use crate::inputs::range::not_negative;
use crate::inputs::sensor_errors::{NOISES, all_strengths};
use crate::random::Seed;
use crate::signal::{
    Chain, MAX_STRENGTHS, Noise, Quantity, Recording, SignalStep, SignalWorkspace,
};
use crate::spelling::nearest_names;
use crate::world::Patch;
use std::collections::BTreeMap;

/// Name of the smoothing step of a signal chain. All other step names belong to [noise](NOISES) or sensor errors.
const SMOOTHING: &str = "smoothing_mm";

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
                Err(self.check.error(key, given, allowed))
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
        let found = all_strengths().find(|(_, strength)| strength.key == first);
        let Some((error, _)) = found else {
            let errors = all_strengths().map(|(_, strength)| strength.key);
            let noises = NOISES.iter().map(|(name, _)| *name);
            let names = noises.chain([SMOOTHING]).chain(errors);
            let given = format!("`{first}`");
            return Err(self.check.error(key, given, nearest_names(first, names)));
        };
        let about = error.about();
        if !about.is_of_single_frames() {
            let given = format!("`{first}`, which needs the frames before and after");
            let allowed = "steps that read each frame alone (studies have all)";
            return Err(self.check.error(key, given, allowed));
        }
        let mut strengths = [0.0; MAX_STRENGTHS];
        for (name, &value) in given {
            let mut all = about.strengths.iter();
            let Some(place) = all.position(|strength| strength.key == name) else {
                let given = format!("`{name}` beside `{first}`");
                return Err(self.check.error(key, given, "one step in each { }"));
            };
            let strength = &about.strengths[place];
            let key = &format!("{key}.{name}");
            strengths[place] = self.check.value(
                key,
                value,
                |value| strength.is_allowed(value),
                strength.allowed,
            )?;
        }
        error.step(&strengths[..about.strengths.len()], skin)
    }
}
