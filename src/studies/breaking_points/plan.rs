//! A study of breaking points that can run: each value of each way is a recognition study of its own.

use crate::engine::axes::with_value;
use crate::error::{Error, Result};
use crate::inputs::check::Check;
use crate::studies::breaking_points::scale::WayScale;
use crate::studies::breaking_points::spec::{BreakingPointsSpec, DrivenAs, DrivenTouches, WaySpec};
use crate::studies::recognition::plan::plan::Plan;
use crate::studies::recognition::spec::study::StudySpec;
use toml::{Table, Value};

/// Ways to drive a study, ready to run.
#[derive(Clone, Debug)]
pub struct BreakingPointsPlan {
    /// As it was written.
    pub spec: BreakingPointsSpec,
    /// The recognition study that the ways drive, as it is before any does.
    pub base: Plan,
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
        std::iter::once(&self.learned).chain(&self.tested)
    }
}

impl BreakingPointsPlan {
    /// Checks a study.
    ///
    /// # Errors
    /// The error names `place` (the file) and the first key that is out of its range, or the way and the value at which a key is.
    pub fn new(place: &str, spec: BreakingPointsSpec) -> Result<Self> {
        let check = Check { place };
        let mut base = Table::try_from(&spec).expect("every field of a study has a TOML form");
        // The recognition study that the ways drive. Words are no part of what a value depends on.
        base.remove("breaking_points");
        base.remove("expected");
        base.insert("question".to_owned(), String::new().into());
        let undriven = plan_at(place, base.clone())?;
        let names = spec.breaking_points.iter().map(|way| &way.name[..]);
        check.list("breaking_points.name", names.collect())?;
        let ways = spec.breaking_points.iter().enumerate();
        let ways = ways.map(|(index, way)| {
            let place = format!("{place}, breaking_points[{}]", index + 1);
            plan_way(&place, way, &base)
        });
        let ways = ways.collect::<Result<_>>()?;
        Ok(Self {
            spec,
            base: undriven,
            ways,
        })
    }
}

/// Checks a way; `place` is the file and the way's number, from 1.
fn plan_way(place: &str, spec: &WaySpec, base: &Table) -> Result<PlannedWay> {
    let check = Check { place };
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    if spec.name.is_empty() || !spec.name.chars().all(is_word) {
        let given = format!("'{}'", spec.name);
        return Err(check.error("name", given, "letters, digits and _"));
    }
    if spec.keys.is_empty() {
        return Err(check.error("keys", "an empty list", "at least one key of the study"));
    }
    let with = |study: &Table, key: &str, value: Value| {
        let allowed = "a key of the study, such as signal.smoothing_mm";
        with_value(study, key, value).map_err(|_| check.error("keys", key, allowed))
    };
    let numbers = numbers(&check, spec)?;
    let mut beside = base.clone();
    for (key, value) in &spec.beside {
        beside = with(&beside, key, value.clone())?;
    }
    let others = match spec.touches {
        DrivenTouches::All => None,
        _ => Some(plan_at(&format!("{place} beside"), beside.clone())?),
    };
    let values = numbers.iter().zip(&spec.values).map(|(&value, given)| {
        let mut table = beside.clone();
        for key in &spec.keys {
            table = with(&table, key, driven(spec.driven_as, given, value))?;
        }
        let driven = plan_at(&format!("{place} at {value}"), table)?;
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
fn numbers(check: &Check, spec: &WaySpec) -> Result<Vec<f64>> {
    let number = |value: &Value| match value {
        Value::Integer(number) => Ok(*number as f64),
        Value::Float(number) if number.is_finite() => Ok(*number),
        other => Err(check.error("values", other, "finite numbers")),
    };
    let numbers = spec.values.iter().map(number);
    let numbers = numbers.collect::<Result<Vec<_>>>()?;
    if numbers.len() < 3 {
        let given = format!("{} values", numbers.len());
        return Err(check.error("values", given, "at least 3"));
    }
    if let Some(pair) = numbers.windows(2).find(|pair| pair[0] >= pair[1]) {
        let given = format!("{} before {}", pair[0], pair[1]);
        return Err(check.error("values", given, "ascending values"));
    }
    if spec.scale == WayScale::Logarithmic && numbers[0] < 0.0 {
        let allowed = "zero or more, or scale = \"linear\"";
        return Err(check.error("values", numbers[0], allowed));
    }
    Ok(numbers)
}

/// What a key makes of a value.
fn driven(driven_as: DrivenAs, given: &Value, value: f64) -> Value {
    match driven_as {
        DrivenAs::Value => given.clone(),
        DrivenAs::HalfWidth if value == 0.0 => Value::Float(0.0),
        DrivenAs::HalfWidth => {
            let ends = [-value, value].map(Value::Float).to_vec();
            let spread = [("uniform".to_owned(), Value::Array(ends))];
            Value::Table(spread.into_iter().collect())
        }
    }
}

/// The recognition study that a table is, every axis of which but that of classifiers has one value.
fn plan_at(place: &str, table: Table) -> Result<Plan> {
    let spec: std::result::Result<StudySpec, _> = table.try_into();
    let spec = spec.map_err(|error| {
        let said = error.message().trim().replace('\n', " ");
        Error::input(place, said, "keys and values of a recognition study")
    })?;
    let plan = Plan::new(place, spec)?;
    let of_signal = ("signal", plan.conditions().len());
    let lengths = || plan.spec.axis_lengths().chain([of_signal]);
    let several = lengths().find(|(key, n)| *n != 1 && *key != "recognition.classifier");
    if let Some((key, n)) = several {
        let allowed = "one: values are swept by breaking_points, and only classifiers compared";
        return Err(Check { place }.error(key, format!("{n} settings"), allowed));
    }
    Ok(plan)
}
