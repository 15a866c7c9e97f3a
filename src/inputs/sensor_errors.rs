//! Strengths of a study's sensor errors, and the choice of the skin that test touches use.

use crate::inputs::keys::{AxisPlace, KeyAbout};
use crate::inputs::params::words;
use crate::inputs::range::Range;
use crate::inputs::toml_value::number_value;
use crate::random::Seed;
use crate::signal::{NoiseUnit, SensorError, SignalStep, Strength};
use crate::table::{Column, Role, Scale};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};

words! {
    /// Skin of the test touches, compared with the skin of the training touches.
    pub enum TestSensor = SameSkin {
        /// The test touches use the skin of the training touches, whose individual errors a classifier may learn.
        SameSkin = "same_skin",
        /// Each trial uses another skin of the same type for testing: gains, drift and faults are drawn again.
        AnotherSkin = "another_skin",
    }
}

/// Returns the strengths (parameters) of all sensor errors in the order of table columns, from the material to the electronics.
pub fn all_strengths() -> impl Iterator<Item = (SensorError, &'static Strength)> {
    static ALL: LazyLock<Vec<(SensorError, &Strength)>> = LazyLock::new(|| {
        let of_error = |error: SensorError| {
            let strengths = error.about().strengths.iter();
            strengths.map(move |strength| (error, strength))
        };
        SensorError::all().flat_map(of_error).collect()
    });
    ALL.iter().copied()
}

/// Numeric key of `[signal]`: the standard deviation of the noise or of the smoothing, or a strength of a sensor error.
pub(crate) struct SignalKey {
    /// Description of the key.
    pub about: KeyAbout,
    /// Meaning of the key, for the reference page.
    pub words: String,
    /// Whether the numbers of the key are whole.
    pub is_whole: bool,
    /// Sensor error with this strength; `None` for noise and smoothing.
    pub error: Option<SensorError>,
}

/// Key of the smoothing.
pub(crate) const SMOOTHING: &str = "smoothing_mm";

/// Meaning of the key of the smoothing.
pub(crate) const SMOOTHING_WORDS: &str =
    "Standard deviation of the Gaussian smoothing over the array, mm.";

/// Allowed noise standard deviations, as fractions of full scale. At the upper bound, nothing of the signal remains, and squares of features still fit into
/// f32.
const NOISE: Range = Range::ZeroOrBetween(1e-12, 1000.0, "0, or 1e-12 to 1000");

/// Returns the numeric keys that `[signal]` may contain, in the order in which they are swept: noise, smoothing, and the strengths of [`all_strengths`].
pub(crate) fn signal_keys() -> &'static [SignalKey] {
    static KEYS: LazyLock<Vec<SignalKey>> = LazyLock::new(|| {
        let key = |name: &str, role, range, (unit, scale), words| SignalKey {
            about: KeyAbout {
                unit,
                scale: Some(scale),
                ..KeyAbout::new(
                    format!("signal.{name}").leak(),
                    AxisPlace::Table,
                    role,
                    range,
                )
            },
            words,
            is_whole: false,
            error: None,
        };
        let linear = (None, Scale::Linear);
        let mut keys = Vec::new();
        for (name, unit) in NOISES {
            let (range, shown, gives_way) = match unit {
                NoiseUnit::FullScale => (NOISE, (Some("%"), Scale::Share), Some(10)),
                _ => (Range::NotNegative, linear, None),
            };
            let mut noise = key(name, Role::Condition, range, shown, noise_words(unit));
            noise.about.title = Some("noise");
            noise.about.gives_way = gives_way;
            keys.push(noise);
        }
        let mut smoothing = key(
            SMOOTHING,
            Role::Choice,
            Range::NotNegative,
            linear,
            format!("{SMOOTHING_WORDS} Default: no smoothing."),
        );
        smoothing.about.gives_way = Some(9);
        keys.push(smoothing);
        for (error, strength) in all_strengths() {
            let scale = match strength.unit {
                "%" => Scale::Share,
                _ => Scale::Linear,
            };
            let (range, shown) = (Range::Strength(strength), (Some(strength.unit), scale));
            let mut key = key(
                strength.key,
                Role::Condition,
                range,
                shown,
                strength_words(error, strength),
            );
            key.about.title = Some(strength.words);
            key.about.names = Some(strength.names);
            (key.is_whole, key.error) = (strength.is_whole, Some(error));
            keys.push(key);
        }
        keys
    });
    &KEYS
}

/// Returns the table columns with the strengths of all sensor errors, in the order of [`all_strengths`].
pub fn strength_columns() -> &'static [Column] {
    static COLUMNS: LazyLock<Vec<Column>> = LazyLock::new(|| {
        let of_errors = signal_keys().iter().filter(|key| key.error.is_some());
        let column = |SignalKey { about, words, .. }: &SignalKey| {
            let meaning = format!("{words} Present only if the study has the key.");
            about.column(about.name()).meaning(meaning).optional()
        };
        of_errors.map(column).collect()
    });
    &COLUMNS
}

/// Strengths of sensor errors that a study sets, in the units of their keys, by their places in [`all_strengths`]. Configurations with equal strengths share one
/// copy.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Strengths(Arc<BTreeMap<usize, f64>>);

/// Writes the strengths that are not zero, by their keys: a strength that a study does not set equals zero.
impl Serialize for Strengths {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(
            self.present()
                .map(|(_, strength, value)| (strength.key, value)),
        )
    }
}

impl Strengths {
    /// Returns the strength that the study sets with this key; `None` if the study does not set it.
    pub fn get(&self, key: &str) -> Option<f64> {
        let mut given = self.given();
        given.find_map(|(_, strength, value)| (strength.key == key).then_some(value))
    }

    /// Returns a copy in which the strength with this key has a different value; `None` for a strength that the study does not set.
    pub fn with(mut self, key: &str, value: Option<f64>) -> Self {
        if let Some(place) = all_strengths().position(|(_, strength)| strength.key == key) {
            let given = Arc::make_mut(&mut self.0);
            match value {
                // Adding 0 makes a negative zero positive.
                Some(value) => given.insert(place, value + 0.0),
                None => given.remove(&place),
            };
        }
        self
    }

    /// Returns the strengths of sensor errors that the study sets.
    pub fn given(&self) -> impl Iterator<Item = (SensorError, &'static Strength, f64)> {
        let all = all_strengths().enumerate();
        all.filter_map(|(place, (error, strength))| Some((error, strength, *self.0.get(&place)?)))
    }

    /// Returns the table cells of the strengths that the study sets: the name of the column and the value.
    pub(crate) fn cells(&self) -> impl Iterator<Item = (&'static str, toml::Value)> {
        self.given()
            .map(|(_, strength, value)| (strength.key, number_value(value, strength.is_whole)))
    }

    /// Returns the strengths of sensor errors that are not zero.
    pub fn present(&self) -> impl Iterator<Item = (SensorError, &'static Strength, f64)> {
        self.given().filter(|(_, _, value)| *value != 0.0)
    }

    /// Returns the signal step that applies a sensor error with these strengths.
    pub(crate) fn step(&self, error: SensorError, skin: &Seed) -> SignalStep {
        let strengths = error.about().strengths.iter();
        let strengths = strengths.map(|strength| self.get(strength.key).unwrap_or(0.0));
        let step = error.step(&strengths.collect::<Vec<_>>(), *skin);
        step.expect("one number for each strength")
    }
}

/// Keys that set the standard deviation of the noise, each with the unit of the standard deviation.
pub(crate) const NOISES: [(&str, NoiseUnit); 3] = [
    ("noise_std_full_scale", NoiseUnit::FullScale),
    ("noise_std_mm", NoiseUnit::Mm),
    ("noise_std_n", NoiseUnit::N),
];

/// Returns the description of the key that sets the noise standard deviation in this unit.
fn noise_words(unit: NoiseUnit) -> String {
    let unit = match unit {
        NoiseUnit::FullScale => "as a fraction of the full scale",
        NoiseUnit::Mm => "mm of deflection",
        NoiseUnit::N => "newtons of force",
    };
    format!("Standard deviation of the noise, {unit}.")
}

/// Returns the description of the key that sets a strength of a sensor error.
fn strength_words(error: SensorError, strength: &Strength) -> String {
    let (step, allowed) = (error.about().step, strength.allowed);
    format!("Sensor error `{step}`: {}, {allowed}.", strength.words)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inputs::params::keys_of;
    use crate::signal::{ErrorAbout, SENSOR_ERRORS};
    use crate::study::SignalSpec;

    #[test]
    fn a_strength_is_found_by_its_key_and_zero_is_none_of_it() {
        let all: Vec<_> = all_strengths().collect();
        let built_in = SENSOR_ERRORS
            .iter()
            .map(|error| error.about().strengths.len());
        assert_eq!(all.len(), built_in.sum::<usize>());
        for (error, strength) in all {
            let strengths = Strengths::default().with(strength.key, Some(0.5));
            assert_eq!(strengths.get(strength.key), Some(0.5));
            let present: Vec<_> = strengths.present().map(|(e, s, v)| (e, s.key, v)).collect();
            assert_eq!(present, [(error, strength.key, 0.5)]);
            let none = strengths.clone().with(strength.key, Some(0.0));
            assert_eq!((none.present().count(), none.given().count()), (0, 1));
        }
    }

    #[test]
    fn a_registered_error_may_not_take_a_word_of_signal() {
        let keys = keys_of::<SignalSpec>().iter().map(|key| key.name());
        let steps = ["force", "noise", "smoothing", "gain"];
        let mut n_refused = 0;
        for word in keys.chain(steps) {
            for [step, key] in [[word, "free"], ["free", word], [word, word]] {
                let strength = Strength::fraction(String::from(key).leak(), "share");
                let about =
                    ErrorAbout::new(String::from(step).leak(), vec![strength].leak(), |_, _| {
                        unreachable!("it is refused")
                    });
                let said = SensorError::register("1", about).unwrap_err().to_string();
                assert!(said.contains("that no other part has"), "{said}");
                n_refused += 1;
            }
        }
        assert!(n_refused > 60, "{n_refused}");
    }

    #[test]
    fn strengths_are_told_with_their_units() {
        for (key, value, words) in [
            ("gain_std", 0.07, "gain mismatch 7 %"),
            ("adc_bits", 8.0, "converter 8 bits"),
            ("scan_time_ms", 12.5, "scan time 12.5 ms"),
        ] {
            let column = strength_columns().iter().find(|c| c.name == key).unwrap();
            assert_eq!(column.phrase(&value.into()), words);
        }
    }
}
