//! Specification of the signal chain: the table `[signal]`.

use crate::engine::axes::CombineSpec;
use crate::engine::axis::Axis;
use crate::inputs::keys::{AxisPlace, KeyAbout};
use crate::inputs::params::{Described, empty_table, is_default, key_schema, params, unknown};
use crate::inputs::range::Range::{self, Any, Unchecked};
use crate::inputs::sensor_errors::{
    NOISES, TestSensor, all_strengths, noise_words, strength_keys, strength_words,
};
use crate::signal::{NoiseUnit, SensorError};
use crate::table::{Role, Scale};
use serde::de::MapAccess;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::LazyLock;

params! {
    /// Keys of `[signal]`: noise, sensor errors and processing of the readings.
    pub struct SignalSpec {
        /// Steps of the signal chain, applied to the frames in this order; each step at most once. Default: `noise`, `smoothing`.
        steps: Vec<StepSpec> = vec![StepSpec::Noise, StepSpec::Smoothing] => Unchecked, Choice, Axes;
        /// Numeric keys of the steps, such as the standard deviation of the noise and the strengths of sensor errors. Each key is an axis.
        #[serde(flatten)]
        axes: SignalAxes;
        /// Axis: skin on which test touches are simulated, `same_skin` (default, the training skin) or `another_skin`.
        test_sensor: Option<Axis<TestSensor>> => Any, Condition, Table, scale: Scale::Words, usual: || "same_skin".into();
        /// Rule that combines the axes of `[signal]`: `all` (default) or `one_at_a_time`. The axes of `[signal]` are always combined with all other axes of the
        /// study.
        #[serde(skip_serializing_if = "is_default")]
        combine: CombineSpec = CombineSpec::All => Any, Condition, Axes;
    }
}

/// Numeric axes of `[signal]`, each with its step of the signal chain.
///
/// The noise has one axis: its standard deviation as a fraction of the full scale, in millimetres of deflection or in newtons of force. The smoothing has the
/// standard deviation of its Gaussian, mm. Each sensor error has its own strengths.
///
/// **Hysteresis**: each touch follows another touch of the study, drawn at random and released. **Gains, drift and faults** belong to a skin: they depend only
/// on the seed and the array, and are equal in all touches and trials. **Drift**: a session consists of the study's touches in random order, trial by trial,
/// and starts with zero drift. **Scan**: the press continues at `touches.speed_mm_per_s` while the array is read; the last frame of a touch is read at rest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SignalAxes(BTreeMap<usize, SignalAxis>);

/// Axis of a signal parameter: its key, the signal step to which it belongs, and its values.
pub type SignalAxis = (&'static str, StepSpec, Axis<f64>);

/// Returns all axes that `[signal]` may contain, in the order in which they are swept.
fn all_axes() -> impl Iterator<Item = (&'static str, StepSpec)> {
    let errors = all_strengths().map(|(error, strength)| (strength.key, StepSpec::Error(error)));
    NOISES
        .iter()
        .map(|(key, _)| (*key, StepSpec::Noise))
        .chain([("smoothing_mm", StepSpec::Smoothing)])
        .chain(errors)
}

impl SignalAxes {
    /// Returns the values of the axis with this key; `None` if the study does not set it.
    pub fn get(&self, key: &str) -> Option<&Axis<f64>> {
        let mut given = self.given();
        given.find_map(|(known, _, axis)| (*known == key).then_some(axis))
    }

    /// Returns those axes of `[signal]` that the study sets.
    pub fn given(&self) -> impl Iterator<Item = &SignalAxis> {
        self.0.values()
    }

    /// Sets the values of the signal axis with this key; does nothing if `[signal]` has no such axis.
    fn set(&mut self, key: &str, axis: Axis<f64>) {
        let found = all_axes().enumerate().find(|(_, (known, _))| *known == key);
        if let Some((place, (key, step))) = found {
            self.0.insert(place, (key, step, axis));
        }
    }
}

impl Serialize for SignalAxes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.given().map(|(key, _, axis)| (key, axis)))
    }
}

/// Step of the signal chain, which converts simulated frames to sensor readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum StepSpec {
    /// Conversion of deflections to forces, newtons.
    Force,
    /// Addition of zero-mean Gaussian noise to each reading.
    Noise,
    /// Gaussian smoothing of the readings over the array.
    Smoothing,
    /// Sensor error, such as gain errors or drift, whose strengths are set by separate keys.
    Error(SensorError),
}

impl StepSpec {
    /// Returns the name of the step in study files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::Noise => "noise",
            Self::Smoothing => "smoothing",
            Self::Error(error) => error.about().step,
        }
    }

    /// Returns all steps that a signal chain may have.
    fn all() -> impl Iterator<Item = Self> {
        let errors = SensorError::all().map(Self::Error);
        [Self::Force, Self::Noise, Self::Smoothing]
            .into_iter()
            .chain(errors)
    }
}

impl TryFrom<String> for StepSpec {
    type Error = String;

    fn try_from(word: String) -> Result<Self, String> {
        let found = Self::all().find(|step| step.word() == word || String::from(*step) == word);
        found.ok_or_else(|| {
            let known: Vec<String> = Self::all().map(String::from).collect();
            unknown("variant", &word, &known)
        })
    }
}

impl From<StepSpec> for String {
    fn from(step: StepSpec) -> Self {
        match step {
            StepSpec::Error(error) => error.text(),
            step => step.word().to_owned(),
        }
    }
}

/// The table around the axes reads their keys.
impl<'de> Deserialize<'de> for SignalAxes {
    fn deserialize<D: Deserializer<'de>>(_: D) -> Result<Self, D::Error> {
        Ok(Self::default())
    }
}

impl Described for SignalAxes {
    fn schema() -> Value {
        let keys = all_about().map(|(about, words, is_whole)| {
            let number = match is_whole {
                true => Axis::<u64>::schema(),
                false => Axis::<f64>::schema(),
            };
            (
                about.name().to_owned(),
                key_schema(number, Some(about.range), &[&words]),
            )
        });
        json!({ "properties": Map::from_iter(keys) })
    }

    fn absent() -> Option<Self> {
        Some(Self::default())
    }

    fn describe_keys(_: &str, keys: &mut Vec<KeyAbout>) {
        keys.extend(all_about().map(|(about, ..)| about));
    }

    fn inner_names() -> &'static [&'static str] {
        static NAMES: LazyLock<Vec<&str>> =
            LazyLock::new(|| all_axes().map(|(key, _)| key).collect());
        &NAMES
    }

    fn read_inner<'de, M: MapAccess<'de>>(
        slot: &mut Option<Self>,
        name: &'static str,
        map: &mut M,
    ) -> Result<(), M::Error> {
        let axis = map.next_value()?;
        slot.get_or_insert_default().set(name, axis);
        Ok(())
    }
}

/// Returns the description and the meaning of each numeric key of `[signal]`, and whether its numbers are whole.
fn all_about() -> impl Iterator<Item = (KeyAbout, String, bool)> {
    let key = |name: &str, role, range, scale| {
        let path: &'static str = format!("signal.{name}").leak();
        let about = KeyAbout::new(path, AxisPlace::Table, role, range);
        KeyAbout {
            scale: Some(scale),
            ..about
        }
    };
    let noises = NOISES.iter().map(move |(name, unit)| {
        let about = match unit {
            NoiseUnit::FullScale => KeyAbout {
                unit: Some("%"),
                gives_way: Some(10),
                ..key(name, Role::Condition, NOISE, Scale::Share)
            },
            _ => key(name, Role::Condition, Range::NotNegative, Scale::Linear),
        };
        let about = KeyAbout {
            title: Some("noise"),
            ..about
        };
        (about, noise_words(*unit), false)
    });
    let smoothing = KeyAbout {
        gives_way: Some(9),
        ..key(
            "smoothing_mm",
            Role::Choice,
            Range::NotNegative,
            Scale::Linear,
        )
    };
    let strengths = strength_keys().iter().zip(all_strengths());
    let strengths = strengths.map(|(about, (error, strength))| {
        (*about, strength_words(error, strength), strength.is_whole)
    });
    noises
        .chain([(smoothing, SMOOTHING.to_owned(), false)])
        .chain(strengths)
}

const SMOOTHING: &str =
    "Standard deviation of the Gaussian smoothing over the array, mm. Default: no smoothing.";

/// Allowed noise standard deviations, as fractions of full scale. At the upper bound, nothing of the signal remains, and squares of features still fit into
/// f32.
const NOISE: Range = Range::ZeroOrBetween(1e-12, 1000.0, "0, or 1e-12 to 1000");

impl Described for StepSpec {
    fn schema() -> Value {
        let texts = |step: Self| [step.word().to_owned(), String::from(step)];
        let mut words: Vec<String> = Self::all().flat_map(texts).collect();
        words.dedup();
        json!({ "type": "string", "enum": words })
    }
}

impl Default for SignalSpec {
    fn default() -> Self {
        empty_table()
    }
}
