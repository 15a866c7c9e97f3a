//! Checks of the values of keys in study files. Each error contains the file, the key, the given value, and the allowed values.

use crate::error::{Error, Result};
use crate::inputs::keys::{AxisPlace, GivenKey, KeyAbout};
use crate::inputs::memory::{check_memory, machine_memory};
use crate::inputs::range::Range;
use crate::inputs::toml_value::{number, table_of, value_at};
use crate::inputs::units::{MM, millimetres};
use bubbletouch_sim::text::numbers::short_number;
use serde::Serialize;
use std::any::Any;

/// Maximum number of values that one key may sweep. A longer list indicates a mistake, and the search for duplicates compares all pairs of values.
pub const MAX_VALUES: usize = 10_000;

/// Maximum number of configurations in a study, all of which are created before the first one runs.
const MAX_CONFIGURATIONS: f64 = 1e6;

/// Condition on the keys that a table of a file has together.
#[derive(Clone, Copy, Debug)]
pub enum Rule {
    /// The table has exactly one of the keys.
    OneOf(&'static [&'static str]),
    /// The first key acts only beside one of the others.
    Beside(&'static str, &'static [&'static str]),
    /// The first key excludes the others.
    Excludes(&'static str, &'static [&'static str]),
}

/// Path of a key whose value differs from the usual one, and the error if the value has no effect.
pub(crate) type Effect = (String, Option<Error>);

/// Checker of the keys and values in one study file.
pub struct Check<'a> {
    /// Name of the study file in error messages.
    pub place: &'a str,
}

impl Check<'_> {
    /// Returns the error of a key, with the name of the study file.
    pub fn error(&self, key: &str, given: impl ToString, allowed: impl ToString) -> Error {
        Error::input(format!("{}, key {key}", self.place), given, allowed)
    }

    /// Checks the keys of the table `name` against the list `keys`. Each number must be in the range of its key; each list must contain values and no
    /// duplicates. Keys must not replace each other, and must meet their conditions on the table. An entry of an array of tables has its number in the name:
    /// `stability.parts[1]`.
    ///
    /// # Errors
    /// If the check fails; the error names the file, the key and the allowed values.
    pub fn keys(
        &self,
        name: &str,
        spec: &(impl Serialize + 'static),
        keys: &[KeyAbout],
    ) -> Result<()> {
        let table = table_of(spec);
        let path = name.split('[').next().unwrap_or(name);
        for about in keys {
            let key = about.path.strip_prefix(path);
            let key = key.and_then(|rest| rest.strip_prefix('.'));
            let Some((key, value)) = key.and_then(|key| Some((key, value_at(&table, key)?))) else {
                continue;
            };
            if let Some(replaced) = about.replaces.filter(|own| table.contains_key(*own)) {
                let both = format!("both {replaced} and {key}");
                return Err(self.error(name, both, "one of them"));
            }
            let key = format!("{name}.{key}");
            if !matches!(about.range, Range::Unchecked) {
                self.key_value(&key, value, about)?;
            }
            let given = GivenKey::new(about, value);
            if let Some(error) = given.and_then(|given| self.no_effect(&key, given, &[spec])) {
                return Err(error);
            }
        }
        Ok(())
    }

    /// Checks that the keys of a study meet their conditions on the given values.
    ///
    /// # Errors
    /// If a value that differs from the usual one has no effect.
    pub fn acting(
        &self,
        study: &impl Serialize,
        keys: &[KeyAbout],
        seen: &[&dyn Any],
    ) -> Result<()> {
        let mut effects = self.effects("", study, keys, seen).into_iter();
        let error = effects.find_map(|(_, error)| error);
        error.map_or(Ok(()), Err)
    }

    /// Returns the keys with conditions whose values differ from the usual ones. Each key has its path with the given prefix, and the error if a condition on the
    /// given values is not met.
    pub(crate) fn effects(
        &self,
        prefix: &str,
        study: &impl Serialize,
        keys: &[KeyAbout],
        seen: &[&dyn Any],
    ) -> Vec<Effect> {
        let study = table_of(study);
        let keys = keys.iter().filter(|about| about.acts.is_some());
        let given = keys.filter_map(|about| {
            let given = GivenKey::new(about, value_at(&study, about.path)?)?;
            let path = format!("{prefix}{}", about.path);
            let error = self.no_effect(&path, given, seen);
            Some((path, error))
        });
        given.collect()
    }

    /// Returns the error of a key, with its path, if its value has no effect.
    fn no_effect(&self, path: &str, key: GivenKey, seen: &[&dyn Any]) -> Option<Error> {
        let none = key.no_effect(seen)?;
        Some(self.error(path, none.given, none.allowed))
    }

    /// Checks the value, or the list of values, of a key against its allowed range.
    fn key_value(&self, path: &str, value: &toml::Value, about: &KeyAbout) -> Result<()> {
        let one = std::slice::from_ref(value);
        let values = value.as_array().map_or(one, |values| &values[..]);
        let words: Vec<&str> = values.iter().filter_map(|value| value.as_str()).collect();
        let numbers: Vec<f64> = values.iter().filter_map(number).collect();
        // A table describes a distribution, which its reader checks.
        if numbers.is_empty() && words.is_empty() && !values.is_empty() {
            return Ok(());
        }
        match words.is_empty() {
            false => self.list(path, words).map(drop)?,
            // Two values with equal text in tables would be mistaken for each other.
            true if path.ends_with("_mm") && about.axis == AxisPlace::Table => {
                let shown = numbers.iter().map(|&mm| millimetres(mm * MM));
                self.list(path, shown.collect()).map(drop)?;
            }
            true => self.list(path, numbers.clone()).map(drop)?,
        }
        let mut numbers = numbers.into_iter();
        match numbers.find(|&number| !about.range.contains(number)) {
            Some(number) => Err(self.error(path, number, about.range.words())),
            None => Ok(()),
        }
    }

    /// Checks which keys a table has together; a list or table without entries counts as absent.
    ///
    /// # Errors
    /// If the table `name` breaks a rule; the error names the file and the key.
    pub fn rules(&self, name: &str, table: &impl Serialize, rules: &[Rule]) -> Result<()> {
        let table = table_of(table);
        let given = |keys: &[&str]| -> Vec<String> {
            let given = keys.iter().filter(|key| table.contains_key(**key));
            given.map(|key| format!("`{key}`")).collect()
        };
        for rule in rules {
            match *rule {
                Rule::OneOf(keys) => match &given(keys)[..] {
                    [_] => {}
                    [] => return Err(self.error(name, "none of them", one_of(keys))),
                    several => return Err(self.error(name, several.join(" and "), one_of(keys))),
                },
                Rule::Beside(key, others) => {
                    if table.contains_key(key) && given(others).is_empty() {
                        let allowed = format!("{} beside it", one_of(others));
                        return Err(self.error(&format!("{name}.{key}"), "given alone", allowed));
                    }
                }
                Rule::Excludes(key, others) => {
                    let others = given(others);
                    if table.contains_key(key) && !others.is_empty() {
                        let given = format!("given beside {}", others.join(" and "));
                        return Err(self.error(&format!("{name}.{key}"), given, "one of them"));
                    }
                }
            }
        }
        Ok(())
    }

    /// Checks that the count given under `key` is between 1 and `most`.
    pub(crate) fn count(&self, key: &str, count: usize, most: usize) -> Result<usize> {
        match count {
            0 => Err(self.error(key, 0, "at least 1")),
            count if count <= most => Ok(count),
            count => Err(self.error(key, count, format!("at most {most}"))),
        }
    }

    /// Checks that a study of `n` configurations (the product of all axis lengths) is within the limit.
    ///
    /// # Errors
    /// If the check fails; the error names the file, the key and the allowed values.
    pub fn configurations(&self, n: f64) -> Result<()> {
        if n <= MAX_CONFIGURATIONS {
            return Ok(());
        }
        // Beyond this value, not all digits are exact.
        let given = if n < 1e15 {
            format!("{n:.0} configurations")
        } else {
            format!("{} configurations", short_number(n))
        };
        let allowed = format!(
            "at most {MAX_CONFIGURATIONS}, all combinations of the values of its axes: fewer values, or several studies"
        );
        Err(Error::input(self.place, given, allowed))
    }

    /// Checks that `bytes` bytes fit into the memory of the machine; the error message describes the data by `what`.
    ///
    /// # Errors
    /// If the check fails; the error names the file, the key and the allowed values.
    pub fn memory(&self, key: &str, given: impl ToString, bytes: f64, what: &str) -> Result<()> {
        check_memory(bytes, machine_memory(), what)
            .map_err(|allowed| self.error(key, given, allowed))
    }

    /// Checks that a list of swept values is not empty and has no duplicates, which would repeat configurations.
    ///
    /// # Errors
    /// If the check fails; the error names the file, the key and the allowed values.
    pub fn list<T: Clone + PartialEq + std::fmt::Debug>(
        &self,
        key: &str,
        values: Vec<T>,
    ) -> Result<Vec<T>> {
        if values.is_empty() {
            return Err(self.error(key, "an empty list", "at least one value"));
        }
        if values.len() > MAX_VALUES {
            let allowed = format!("at most {MAX_VALUES} values");
            return Err(self.error(key, format!("{} values", values.len()), allowed));
        }
        for (index, value) in values.iter().enumerate() {
            if values[..index].contains(value) {
                return Err(self.error(key, format!("{value:?} twice"), "each value once"));
            }
        }
        Ok(values)
    }
}

/// Returns the names of keys as text, such as ``one of `mesh`, `parts` ``.
fn one_of(keys: &[&str]) -> String {
    let keys: Vec<String> = keys.iter().map(|key| format!("`{key}`")).collect();
    match &keys[..] {
        [key] => key.clone(),
        keys => format!("one of {}", keys.join(", ")),
    }
}
