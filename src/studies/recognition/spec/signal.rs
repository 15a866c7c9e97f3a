//! What happens to a frame, as it is written: `[signal]`.

use crate::engine::axes::CombineSpec;
use crate::engine::axis::Axis;
use crate::inputs::defaults::is_default;
use crate::inputs::sensor_errors::{NOISES, TestedOn, all_strengths};
use crate::signal::{SENSOR_ERRORS, SensorError};
use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;
use std::fmt;

/// `[signal]`
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SignalSpec {
    /// What is done to a frame of deflections, in this order; each step at most once.
    pub steps: Vec<StepSpec>,
    /// How much of it is done.
    #[serde(flatten)]
    pub axes: SignalAxes,
    /// Axis: the skin that test touches are made with, `same_skin` (as training touches; when left out) or `another_skin`.
    pub tested_on: Option<Axis<TestedOn>>,
    /// How the axes above are combined with each other. (With other axes they always are.)
    #[serde(skip_serializing_if = "is_default")]
    pub combine: CombineSpec,
}

/// Axes of numbers, each with the step that it belongs to: the standard deviation of the noise as a fraction of the full scale, in
/// millimetres (of deflection) or in newtons (of force), which is one axis; that of the Gaussian that smooths, mm; and the strengths of sensor
/// errors, each by its [key](crate::signal::Strength::key).
///
/// Hysteresis: each touch comes after another of the study, drawn at random and let go. Gains, drift and faults belong to a skin: they
/// follow from the seed and the array and are the same in all touches and trials. Drift: a session is the study's touches in random order,
/// trial by trial; it begins with every zero at zero. Scan: the press goes on at `touches.speed_mm_per_s` while the array is read; the last
/// frame of a touch is read at rest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SignalAxes(BTreeMap<usize, SignalAxis>);

/// A key, the step that it belongs to, and its values.
pub type SignalAxis = (&'static str, StepSpec, Axis<f64>);

/// All of them, in the order in which conditions go through them.
fn all_axes() -> impl Iterator<Item = (&'static str, StepSpec)> {
    let errors = all_strengths().map(|(error, strength)| (strength.key, StepSpec::Error(error)));
    NOISES
        .iter()
        .map(|(key, _)| (*key, StepSpec::Noise))
        .chain([("smoothing_mm", StepSpec::Smoothing)])
        .chain(errors)
}

impl SignalAxes {
    /// The axis of a key.
    pub fn of(&self, key: &str) -> Option<&Axis<f64>> {
        let mut given = self.given();
        given.find_map(|(known, _, axis)| (*known == key).then_some(axis))
    }

    /// Those that a study has.
    pub fn given(&self) -> impl Iterator<Item = &SignalAxis> {
        self.0.values()
    }

    /// Puts an axis at a key, if there is such a key.
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

/// A step of the signal stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum StepSpec {
    /// Deflection → force, newtons.
    Force,
    /// Additive zero-mean Gaussian noise.
    Noise,
    /// Gaussian smoothing over the array.
    Smoothing,
    /// A sensor error, with strengths of its own keys.
    Error(SensorError),
}

impl StepSpec {
    /// The step's name in a study.
    pub fn word(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::Noise => "noise",
            Self::Smoothing => "smoothing",
            Self::Error(error) => error.about().step,
        }
    }

    /// Every step.
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

/// A key of `[signal]`.
struct Key(String);

impl<'de> Deserialize<'de> for Key {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        let all = || {
            let axes = all_axes().map(|(key, _)| key);
            ["steps", "tested_on", "combine"].into_iter().chain(axes)
        };
        match all().any(|known| known == key) {
            true => Ok(Self(key)),
            false => Err(D::Error::custom(unknown("field", &key, all()))),
        }
    }
}

/// Written out, because the keys of sensor errors are those that their files say.
impl<'de> Deserialize<'de> for SignalSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(SpecVisitor)
    }
}

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
                "tested_on" => spec.tested_on = Some(map.next_value()?),
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
            tested_on: None,
            combine: CombineSpec::default(),
        }
    }
}
