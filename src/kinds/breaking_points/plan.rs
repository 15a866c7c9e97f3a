//! A study of breaking points that can run: each value of each way is a recognition study of its own.

use super::scale::WayScale;
use super::spec::{BreakingPointsSpec, DrivenAs, DrivenTouches, WaySpec};
use crate::error::{Error, Result};
use crate::study::axes::with_value;
use crate::study::check::Check;
use crate::study::plan::Plan;
use crate::study::spec::StudySpec;
use toml::{Table, Value};

/// Ways to drive a study, ready to run.
#[derive(Clone, Debug)]
pub struct BreakingPointsPlan {
    /// As it was written.
    pub spec: BreakingPointsSpec,
    /// The ways, as they were written.
    pub ways: Vec<PlannedWay>,
}

/// A way to drive a study: an axis along which it is searched.
#[derive(Clone, Debug)]
pub struct PlannedWay {
    /// As it was written.
    pub spec: WaySpec,
    /// Its values, ascending.
    pub values: Vec<PlannedValue>,
}

/// A value of a way.
#[derive(Clone, Debug)]
pub struct PlannedValue {
    /// In the unit of the way's keys.
    pub value: f64,
    /// What is learned.
    pub learned: Plan,
    /// What is tested, if not the same.
    pub tested: Option<Plan>,
}

impl PlannedValue {
    /// The studies that it touches objects for.
    pub fn plans(&self) -> impl Iterator<Item = &Plan> {
        [Some(&self.learned), self.tested.as_ref()]
            .into_iter()
            .flatten()
    }
}

impl BreakingPointsPlan {
    /// Checks a study; the error names `place` (the file) and the first key that is out of its range, or the way and the value
    /// at which a key is.
    pub fn new(place: &str, spec: BreakingPointsSpec) -> Result<Self> {
        let check = Check { place };
        let base = spec.base();
        check_single(&check, &Plan::new(place, base.clone())?)?;
        if spec.breaking_points.is_empty() {
            return Err(check.error("breaking_points", "none", "at least one way"));
        }
        let names: Vec<&str> = spec.breaking_points.iter().map(|w| &w.name[..]).collect();
        check.list("breaking_points.name", names)?;
        let base = Table::try_from(base).expect("every field of a study has a TOML form");
        let ways = spec.breaking_points.iter().enumerate();
        let ways = ways.map(|(index, spec)| {
            let place = format!("{place}, breaking_points[{}]", index + 1);
            Way { place, spec }.plan(&base)
        });
        let ways = ways.collect::<Result<_>>()?;
        Ok(Self { spec, ways })
    }
}

/// A way that is being checked.
struct Way<'a> {
    /// The file and the way's number, from 1.
    place: String,
    spec: &'a WaySpec,
}

impl Way<'_> {
    fn error(&self, key: &str, given: impl ToString, allowed: impl ToString) -> Error {
        Error::input(format!("{}, key {key}", self.place), given, allowed)
    }

    fn plan(&self, base: &Table) -> Result<PlannedWay> {
        let spec = self.spec;
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if spec.name.is_empty() || !spec.name.chars().all(is_word) {
            let given = format!("'{}'", spec.name);
            return Err(self.error("name", given, "letters, digits and _"));
        }
        if spec.keys.is_empty() {
            return Err(self.error("keys", "an empty list", "at least one key of the study"));
        }
        let numbers = self.numbers()?;
        let mut beside = base.clone();
        for (key, value) in &spec.beside {
            beside = self.with(&beside, key, value.clone())?;
        }
        let others = match spec.touches {
            DrivenTouches::All => None,
            _ => Some(self.study("beside", beside.clone())?),
        };
        let values = numbers.iter().zip(&spec.values).map(|(&value, given)| {
            let mut table = beside.clone();
            for key in &spec.keys {
                table = self.with(&table, key, self.driven(given, value))?;
            }
            let driven = self.study(&format!("at {value}"), table)?;
            let (learned, tested) = match (others.clone(), spec.touches) {
                (Some(others), DrivenTouches::Training) => (driven, Some(others)),
                (Some(others), DrivenTouches::Test) => (others, Some(driven)),
                _ => (driven, None),
            };
            Ok(PlannedValue {
                value,
                learned,
                tested,
            })
        });
        Ok(PlannedWay {
            values: values.collect::<Result<_>>()?,
            spec: spec.clone(),
        })
    }

    /// The values as ascending numbers that the scale has places for.
    fn numbers(&self) -> Result<Vec<f64>> {
        let number = |value: &Value| match value {
            Value::Integer(number) => Ok(*number as f64),
            Value::Float(number) if number.is_finite() => Ok(*number),
            other => Err(self.error("values", other, "finite numbers")),
        };
        let numbers = self.spec.values.iter().map(number);
        let numbers = numbers.collect::<Result<Vec<_>>>()?;
        if numbers.len() < 3 {
            return Err(self.error("values", format!("{} values", numbers.len()), "at least 3"));
        }
        if let Some(pair) = numbers.windows(2).find(|pair| pair[0] >= pair[1]) {
            let given = format!("{} before {}", pair[0], pair[1]);
            return Err(self.error("values", given, "ascending values"));
        }
        let is_logarithmic = self.spec.scale == WayScale::Logarithmic;
        if is_logarithmic && numbers[0] < 0.0 {
            let allowed = "zero or more, or scale = \"linear\"";
            return Err(self.error("values", numbers[0], allowed));
        }
        if self.spec.driven_as == DrivenAs::HalfWidth && numbers[0] < 0.0 {
            return Err(self.error("values", numbers[0], "zero or more: half widths"));
        }
        Ok(numbers)
    }

    fn driven(&self, given: &Value, value: f64) -> Value {
        match self.spec.driven_as {
            DrivenAs::Value => given.clone(),
            DrivenAs::HalfWidth if value == 0.0 => Value::Float(0.0),
            DrivenAs::HalfWidth => {
                let ends = [-value, value].map(Value::Float).to_vec();
                let spread = [("uniform".to_owned(), Value::Array(ends))];
                Value::Table(spread.into_iter().collect())
            }
        }
    }

    /// The study with a value at a key, such as `signal.noise_std_n`.
    fn with(&self, study: &Table, key: &str, value: Value) -> Result<Table> {
        let allowed = "a key of the study, such as signal.smoothing_mm";
        with_value(study, key, value).map_err(|_| self.error("keys", key, allowed))
    }

    /// The recognition study that a table is.
    fn study(&self, at: &str, table: Table) -> Result<Plan> {
        let place = format!("{} {at}", self.place);
        let spec: std::result::Result<StudySpec, _> = table.try_into();
        let spec = spec.map_err(|error| {
            let said = error.message().trim().replace('\n', " ");
            Error::input(&place, said, "keys and values of a recognition study")
        })?;
        let plan = Plan::new(&place, spec)?;
        check_single(&Check { place: &place }, &plan)?;
        Ok(plan)
    }
}

/// Every axis but that of classifiers has one value.
fn check_single(check: &Check, plan: &Plan) -> Result<()> {
    let of_signal = ("signal", plan.conditions().len());
    let mut lengths = plan.spec.axis_lengths().chain([of_signal]);
    match lengths.find(|(key, n)| *n != 1 && *key != "recognition.classifier") {
        None => Ok(()),
        Some((key, n)) => {
            let allowed = "one: values are swept by breaking_points, and only classifiers compared";
            Err(check.error(key, format!("{n} settings"), allowed))
        }
    }
}
