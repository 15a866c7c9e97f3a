//! Signal chain of a patch with checked steps; it converts deflections or forces to sensor output.

use super::planned::PlannedSignal;
use super::reader::Reader;
use super::spec::SignalStepSpec;
use crate::error::Result;
use crate::inputs::range::Range;
use crate::inputs::sensor_errors::{NOISES, SMOOTHING, all_strengths, signal_keys};
use crate::inputs::units::MM;
use crate::random::Seed;
use crate::signal::{Chain, Noise, Quantity, SignalStep};
use crate::spelling::nearest_names;
use crate::world::Patch;
use std::collections::BTreeMap;

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
        let Some((first, &value)) = given.first_key_value() else {
            let allowed = "one step's keys: { noise_std_n = 0.1 }";
            return self.refuse(key, "a step without a key", allowed);
        };
        let noise = NOISES.iter().find(|(name, _)| name == first);
        let error = all_strengths().find(|(_, strength)| strength.key == first);
        let keys: Vec<(&str, Range)> = match error {
            Some((error, _)) if !error.about().is_of_single_frames() => {
                let given = format!("`{first}`, which needs the frames before and after");
                let allowed = "steps that read each frame alone (studies have all)";
                return self.refuse(key, given, allowed);
            }
            Some((error, _)) => {
                let strengths = error.about().strengths.iter();
                let keys = strengths.map(|strength| (strength.key, Range::Strength(strength)));
                keys.collect()
            }
            None if noise.is_some() || first == SMOOTHING => vec![(first, Range::NotNegative)],
            None => {
                let names = signal_keys().iter().map(|key| key.about.name());
                let offered = nearest_names(first, names);
                return self.refuse(key, format!("`{first}`"), offered);
            }
        };
        for (name, value) in given {
            let Some((_, range)) = keys.iter().find(|(own, _)| own == name) else {
                let given = format!("`{name}` beside `{first}`");
                return self.refuse(key, given, "one step in each { }");
            };
            if !range.contains(*value) {
                return self.refuse(&format!("{key}.{name}"), value, range.words());
            }
        }
        match (error, noise) {
            (Some((error, _)), _) => {
                let values = keys.iter().map(|(name, _)| given.get(*name).copied());
                let values: Vec<f64> = values.map(Option::unwrap_or_default).collect();
                error.step(&values, skin)
            }
            (None, Some(&(_, unit))) => Ok(SignalStep::Noise(Noise { std: value, unit })),
            (None, None) => Ok(SignalStep::Smoothing { width: value * MM }),
        }
    }
}
