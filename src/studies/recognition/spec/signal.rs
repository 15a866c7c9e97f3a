//! Specification of the signal chain: the table `[signal]`.

use crate::acts;
use crate::engine::axes::CombineSpec;
use crate::engine::axis::Axis;
use crate::inputs::keys::KeyAbout;
use crate::inputs::params::{Described, empty_table, is_default, key_schema, params, unknown};
use crate::inputs::range::Range::{Any, Unchecked};
use crate::inputs::sensor_errors::{SMOOTHING, TestSensor, signal_keys};
use crate::signal::SensorError;
use crate::studies::recognition::plan::Plan;
use crate::studies::recognition::spec::OneArray;
use crate::table::Scale;
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
        test_sensor: Option<Axis<TestSensor>> => Any, Condition, Table, scale: Scale::Words, usual: || "same_skin".into(), of_all_touches: true,
            acts: acts![OneArray: |_of| false => "", "no such key: only studies of recognition test on another skin"];
        /// Rule that combines the axes of `[signal]`: `all` (default) or `one_at_a_time`. The axes of `[signal]` are always combined with all other axes of the
        /// study.
        #[serde(skip_serializing_if = "is_default")]
        combine: CombineSpec = CombineSpec::All => Any, Condition, Axes, of_all_touches: true, acts: acts![
            Plan: |plan| plan.spec.signal.axes.given().filter(|(.., axis)| axis.values().len() > 1).count() > 1
                => "fewer than two keys of [signal] have several values", "no such key, or two axes in [signal]";
            OneArray: |_of| false => "", "no such key: noise is the only axis of the signal, so that there is nothing to combine";
        ];
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
        let found = signal_keys()
            .iter()
            .position(|known| known.about.name() == key);
        if let Some(place) = found {
            let known = &signal_keys()[place];
            let step = match known.error {
                Some(error) => StepSpec::Error(error),
                None if known.about.name() == SMOOTHING => StepSpec::Smoothing,
                None => StepSpec::Noise,
            };
            self.0.insert(place, (known.about.name(), step, axis));
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
        let keys = signal_keys().iter().map(|key| {
            let number = match key.is_whole {
                true => Axis::<u64>::schema(),
                false => Axis::<f64>::schema(),
            };
            let schema = key_schema(number, Some(key.about.range), &[&key.words]);
            (key.about.name().to_owned(), schema)
        });
        json!({ "properties": Map::from_iter(keys) })
    }

    fn absent() -> Option<Self> {
        Some(Self::default())
    }

    fn describe_keys(_: &str, keys: &mut Vec<KeyAbout>) {
        keys.extend(signal_keys().iter().map(|key| key.about));
    }

    fn inner_names() -> &'static [&'static str] {
        static NAMES: LazyLock<Vec<&str>> =
            LazyLock::new(|| signal_keys().iter().map(|key| key.about.name()).collect());
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
