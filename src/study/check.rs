//! Checks of single keys: each error names the file and the key, what was given and what is allowed.

use super::axis::Axis;
use super::memory::{check_memory, machine_memory};
use crate::error::{Error, Result};

pub fn positive(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

pub fn not_negative(value: f64) -> bool {
    value.is_finite() && value >= 0.0
}

/// Values of one axis, at most: more is a slip, and each would be compared with all others.
pub const MOST_VALUES: usize = 10_000;

/// What a key may count, at most: what is counted is in memory at once, or takes for ever.
const MOST_COUNTED: usize = 100_000_000;

/// Configurations of a study, at most: all are laid out before the first runs.
const MOST_CONFIGURATIONS: f64 = 1e6;

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
        self.count(key, count, MOST_COUNTED)
    }

    /// From 1 to so many.
    pub fn count(&self, key: &str, count: usize, most: usize) -> Result<usize> {
        match count {
            0 => Err(self.error(key, 0, "at least 1")),
            count if count <= most => Ok(count),
            count => Err(self.error(key, count, format!("at most {most}"))),
        }
    }

    /// So many configurations, the product of all axes, can be laid out.
    pub fn configurations(&self, n: f64) -> Result<()> {
        if n <= MOST_CONFIGURATIONS {
            return Ok(());
        }
        // Beyond that, not every digit is known.
        let given = if n < 1e15 {
            format!("{n:.0} configurations")
        } else {
            format!("{n:.1e} configurations")
        };
        let allowed = format!(
            "at most {MOST_CONFIGURATIONS}, all combinations of the values of its axes: fewer values, or several studies"
        );
        Err(Error::input(self.place, given, allowed))
    }

    /// So many bytes are within the machine's memory; what takes them is said in words.
    pub fn memory(&self, key: &str, given: impl ToString, bytes: f64, what: &str) -> Result<()> {
        check_memory(bytes, machine_memory(), what)
            .map_err(|allowed| self.error(key, given, allowed))
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
