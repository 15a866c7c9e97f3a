//! Checks of single keys: each error names the file and the key, what was given and what is allowed.

use super::axis::Axis;
use crate::error::{Error, Result};

pub fn positive(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

pub fn not_negative(value: f64) -> bool {
    value.is_finite() && value >= 0.0
}

/// Values of one axis, at most: more is a slip, and each would be compared with all others.
const MOST_VALUES: usize = 10_000;

/// Checks of one file's keys.
pub struct Check<'a> {
    /// The study's file.
    pub place: &'a str,
}

impl Check<'_> {
    pub fn error(&self, key: &str, given: impl ToString, allowed: impl ToString) -> Error {
        Error::input(format!("{}, key {key}", self.place), given, allowed)
    }

    pub fn value(
        &self,
        key: &str,
        value: f64,
        is_allowed: fn(f64) -> bool,
        allowed: &str,
    ) -> Result<f64> {
        if is_allowed(value) {
            return Ok(value);
        }
        Err(self.error(key, value, allowed))
    }

    pub fn positive_count(&self, key: &str, count: usize) -> Result<usize> {
        if count > 0 {
            return Ok(count);
        }
        Err(self.error(key, 0, "at least 1"))
    }

    /// An axis has values, and none twice: a repeated value would only repeat cells.
    pub fn list<T: Clone + PartialEq + std::fmt::Debug>(
        &self,
        key: &str,
        values: Vec<T>,
    ) -> Result<Vec<T>> {
        if values.is_empty() {
            return Err(self.error(key, "an empty list", "at least one value"));
        }
        self.axis_length(key, values.len())?;
        for (index, value) in values.iter().enumerate() {
            if values[..index].contains(value) {
                return Err(self.error(key, format!("{value:?} twice"), "each value once"));
            }
        }
        Ok(values)
    }

    /// An axis of so many values is one that a study can mean.
    pub fn axis_length(&self, key: &str, n_values: usize) -> Result<()> {
        match n_values {
            0..=MOST_VALUES => Ok(()),
            n => Err(self.error(
                key,
                format!("{n} values"),
                format!("at most {MOST_VALUES} values"),
            )),
        }
    }

    pub fn counts(&self, key: &str, axis: &Axis<usize>) -> Result<Vec<usize>> {
        let counts = self.list(key, axis.values())?;
        for &count in &counts {
            self.positive_count(key, count)?;
        }
        Ok(counts)
    }

    pub fn axis(
        &self,
        key: &str,
        axis: &Axis<f64>,
        is_allowed: fn(f64) -> bool,
        allowed: &str,
    ) -> Result<Vec<f64>> {
        let values = self.list(key, axis.values())?;
        for &value in &values {
            self.value(key, value, is_allowed, allowed)?;
        }
        Ok(values)
    }
}
