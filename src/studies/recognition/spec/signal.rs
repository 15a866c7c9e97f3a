//! Specification of the signal chain: the table `[signal]`.

use crate::engine::axes::CombineSpec;
use crate::engine::axis::Axis;
use crate::inputs::defaults::is_default;
use crate::inputs::sensor_errors::{
    NOISES, TestSensor, all_strengths, noise_words, strength_words,
};
use crate::signal::{SENSOR_ERRORS, SensorError};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::LazyLock;

/// Keys of `[signal]`: noise, sensor errors and processing of the readings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SignalSpec {
    /// Steps of the signal chain, applied to the frames in this order; each step at most once. Default: `noise`, `smoothing`.
    pub steps: Vec<StepSpec>,
    /// Numeric keys of the steps, such as the standard deviation of the noise and the strengths of sensor errors. Each key is an axis.
    #[serde(flatten)]
    pub axes: SignalAxes,
    /// Axis: skin on which test touches are simulated, `same_skin` (default, the training skin) or `another_skin`.
    pub test_sensor: Option<Axis<TestSensor>>,
    /// Rule that combines the axes of `[signal]`: `all` (default) or `one_at_a_time`. The axes of `[signal]` are always combined with all other axes of the
    /// study.
    #[serde(skip_serializing_if = "is_default")]
    pub combine: CombineSpec,
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
        let errors = SENSOR_ERRORS.iter().map(|error| Self::Error(*error));
        [Self::Force, Self::Noise, Self::Smoothing]
            .into_iter()
            .chain(errors)
    }
}

impl TryFrom<String> for StepSpec {
    type Error = String;

    fn try_from(word: String) -> Result<Self, String> {
        let found = Self::all().find(|step| step.word() == word);
        found.ok_or_else(|| unknown("variant", &word, Self::all().map(Self::word)))
    }
}

impl From<StepSpec> for String {
    fn from(step: StepSpec) -> Self {
        step.word().to_owned()
    }
}

fn unknown(what: &str, given: &str, known: impl Iterator<Item = &'static str>) -> String {
    let known: Vec<String> = known.map(|word| format!("`{word}`")).collect();
    format!(
        "unknown {what} `{given}`, expected one of {}",
        known.join(", ")
    )
}

/// Names of all keys that `[signal]` may contain.
static KEYS: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
    let axes = all_axes().map(|(key, _)| key);
    ["steps", "test_sensor", "combine"]
        .into_iter()
        .chain(axes)
        .collect()
});

struct Key(String);

impl<'de> Deserialize<'de> for Key {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        match KEYS.contains(&&key[..]) {
            true => Ok(Self(key)),
            false => Err(D::Error::unknown_field(&key, &KEYS)),
        }
    }
}

/// Deserialises the table `[signal]`; the code is not derived, because each sensor error defines its own keys.
impl<'de> Deserialize<'de> for SignalSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(SpecVisitor)
    }
}

/// Schema of `[signal]`, built from the list of sensor errors that also defines the accepted keys.
impl JsonSchema for SignalSpec {
    fn schema_name() -> Cow<'static, str> {
        "SignalSpec".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let number = generator.subschema_for::<Axis<f64>>();
        let integer = generator.subschema_for::<Axis<u64>>();
        let words: Vec<&str> = StepSpec::all().map(StepSpec::word).collect();
        let steps = SignalSpec::default().steps;
        let mut keys = serde_json::Map::new();
        let mut add = |key: &str, mut schema: Schema, description: &str| {
            schema.insert("description".to_owned(), description.into());
            keys.insert(key.to_owned(), schema.into());
        };
        let list = json_schema!({
            "type": "array",
            "items": { "type": "string", "enum": words },
            "uniqueItems": true,
            "default": steps,
        });
        let order = "Steps of the signal chain, applied to a frame of deflections in this order; each step at most once.";
        add("steps", list, order);
        for (key, unit) in NOISES {
            add(key, number.clone(), &noise_words(unit));
        }
        add("smoothing_mm", number.clone(), SMOOTHING);
        for (error, strength) in all_strengths() {
            let schema = match strength.is_whole {
                true => &integer,
                false => &number,
            };
            add(
                strength.key,
                schema.clone(),
                &strength_words(error, strength),
            );
        }
        let sensor = generator.subschema_for::<Axis<TestSensor>>();
        add("test_sensor", sensor, TEST_SENSOR);
        let mut combine = generator.subschema_for::<CombineSpec>();
        combine.insert("default".to_owned(), "all".into());
        add("combine", combine, COMBINE);
        json_schema!({ "type": "object", "properties": keys, "additionalProperties": false })
    }
}

const SMOOTHING: &str =
    "Standard deviation of the Gaussian smoothing over the array, mm. Default: no smoothing.";
const TEST_SENSOR: &str =
    "Sensor of the test touches. Default: the sensor of the training touches.";
const COMBINE: &str = "How the axes of `[signal]` are combined with each other. All combinations with other axes are run.";

struct SpecVisitor;

impl<'de> Visitor<'de> for SpecVisitor {
    type Value = SignalSpec;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a table of what happens to a frame")
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<SignalSpec, M::Error> {
        let mut spec = SignalSpec::default();
        while let Some(Key(key)) = map.next_key()? {
            match &key[..] {
                "steps" => spec.steps = map.next_value()?,
                "test_sensor" => spec.test_sensor = Some(map.next_value()?),
                "combine" => spec.combine = map.next_value()?,
                axis => spec.axes.set(axis, map.next_value()?),
            }
        }
        Ok(spec)
    }
}

impl Default for SignalSpec {
    fn default() -> Self {
        Self {
            steps: vec![StepSpec::Noise, StepSpec::Smoothing],
            axes: SignalAxes::default(),
            test_sensor: None,
            combine: CombineSpec::default(),
        }
    }
}
