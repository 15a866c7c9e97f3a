//! Table `[axes]` of a study: keys with lists of values, from which all combinations are formed.
//!
//! ```toml
//! [axes]
//! "touches.depth_mm" = [1.0, 2.0, 4.0]
//! "skin.stiffness_n_per_m" = [500.0, 2000.0]
//! ```
//! A key in `[axes]` replaces the same key in its own table. Each combination of values is a study of its own and is checked as any other study. A key that
//! accepts a list in its own table is also an axis there, and may be written in either place. `"touches.offset_{x,y}_mm"` sets two keys together.
//!
//! With `combine = "one_at_a_time"`, the first configuration has the values of the study's own tables. In each further configuration, one axis alone takes
//! another value. The keys may then also have values in their own tables.

use crate::error::{Error, Result};
use crate::inputs::check::MAX_VALUES;
use crate::inputs::keys::{AxisPlace, KeyAbout, find as find_key};
use crate::inputs::renamed_keys::check_renamed;
use crate::inputs::toml_value::{number, value_at};
use crate::table::{Column, Role, Scale};
use crate::toml_lines::line_of;
use crate::toml_text::{check_brackets, check_numbers};
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Rule that selects the combinations of axis values that become configurations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CombineSpec {
    /// All combinations of the values of the axes are computed.
    #[default]
    All,
    /// A base configuration, and variants in which a single axis has another value than in the base configuration. The base has the first value of each axis;
    /// for `[axes]`, it has the values of the study's own tables.
    OneAtATime,
}

/// Axes of a study that its table `[axes]` declares; the last axis changes fastest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyAxes {
    /// Axes in the order in which they are written in the study file.
    pub axes: Vec<StudyAxis>,
    /// Rule that selects the combinations of axis values that become configurations.
    pub combine: CombineSpec,
}

/// Axis of a study: a key of the study file that is varied, and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyAxis {
    /// Path of the key, such as `touches.depth_mm`, or `touches.offset_{x,y}_mm` for two keys.
    pub key: String,
    /// Description of the key that is varied; of the first key if several keys are varied together. For keys of test touches, the description of the key
    /// without `test.`.
    pub about: Option<&'static KeyAbout>,
    /// Whether result tables already contain a column with the values of this key.
    pub has_column: bool,
    /// Distinct values of the axis, at least one.
    pub values: Vec<toml::Value>,
    /// Line number of the key in the study file; `None` if the axis does not come from a file.
    pub line: Option<usize>,
}

/// Values of one configuration on all axes of the study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisValues {
    /// Number of the combination of values, from 0.
    pub number: usize,
    /// Value of each axis that has no separate column in result tables.
    pub values: Arc<[AxisValue]>,
}

impl AxisValues {
    /// Creates the axis values of the combination with this number. The columns of those axes that result tables do not have yet are `columns`.
    pub fn new(
        number: usize,
        (axes, columns): (&StudyAxes, &[Column]),
        values: &[Option<toml::Value>],
    ) -> Self {
        use toml::Value::{Boolean, Float, Integer, String};
        let axes = axes.axes.iter().zip(values);
        let shown = axes.filter(|(axis, _)| !axis.has_column);
        let values = columns.iter().zip(shown);
        let values = values.map(|(column, (_, value))| AxisValue {
            column: column.clone(),
            value: value.as_ref().map(|value| match value {
                Integer(_) | Float(_) | Boolean(_) | String(_) => value.clone(),
                other => other.to_string().into(),
            }),
        });
        Self {
            number,
            values: values.collect(),
        }
    }
}

/// Value of one configuration on an axis, as it is written in result tables.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisValue {
    /// Column of the result tables that contains the values of the axis.
    pub column: Column,
    /// Number, truth value or text on the axis; lists and tables are converted to text. The field is `None` if the axis keeps the value of the study and the
    /// study has no such value.
    pub value: Option<toml::Value>,
}

/// Returns the table that contains the last key of a dotted path, and the name of this key. Missing tables along the path are created. Returns `None` if a part
/// of the path is not a table.
fn table_at<'t, 'k>(
    table: &'t mut toml::Table,
    path: &'k str,
) -> Option<(&'t mut toml::Table, &'k str)> {
    let Some((first, rest)) = path.split_once('.') else {
        return Some((table, path));
    };
    let inner = table.entry(first);
    let inner = inner.or_insert_with(|| toml::Table::new().into());
    table_at(inner.as_table_mut()?, rest)
}

/// Returns a copy of `table` in which the dotted path `key` has the given value. Missing tables along the path are created, and an existing value is replaced.
///
/// # Errors
/// If the path is empty, or if a part of it is not a table.
pub fn with_value(table: &toml::Table, key: &str, value: toml::Value) -> Result<toml::Table> {
    let mut changed = table.clone();
    match table_at(&mut changed, key) {
        Some((inner, last)) if !key.split('.').any(str::is_empty) => {
            inner.insert(last.to_owned(), value);
            Ok(changed)
        }
        _ => {
            let allowed = "names of tables and of a key, with a point between them: skin.stroke_mm";
            Err(Error::input("key", format!("{key:?}"), allowed))
        }
    }
}

/// Reads a study file with its axes, after checking that it contains only allowed keys. In the returned study, each key of an axis has its first value; keys
/// that accept lists have all values.
///
/// # Errors
/// If the study is invalid. If an axis has no values, a repeated value, a key that is also given elsewhere, or a key that cannot be an axis. The error names
/// the file, the line and the key.
pub fn read<S: DeserializeOwned>(
    place: &str,
    text: &str,
    keys: &'static [KeyAbout],
) -> Result<(S, StudyAxes)> {
    check_brackets(place, text)?;
    check_numbers(place, text)?;
    let said = |error| Error::toml(place, text, &error);
    let mut table = DeTable::parse(text).map_err(said)?;
    check_renamed(place, text, table.get_ref())?;
    let mut found = Vec::new();
    if let Some((name, given)) = table.get_mut().remove_entry("axes") {
        let line = line_of(text, name.span().start);
        match given.into_inner() {
            DeValue::Table(axes) => leaves(String::new(), axes, &mut found),
            _ => {
                let allowed = "a table of keys, each with a list of its values";
                let place = format!("{place}:{line}, key axes");
                return Err(Error::input(place, "no table", allowed));
            }
        }
    }
    // Axes are kept in the order in which they are written.
    found.sort_by_key(|(_, start, _)| *start);
    let mut axes = StudyAxes {
        combine: take_combine(place, text, &mut found)?,
        ..StudyAxes::default()
    };
    for (key, start, value) in found {
        let line = line_of(text, start);
        let values = list(place, text, &value)?;
        let axis = StudyAxis {
            line: Some(line),
            ..StudyAxis::new(key, values, keys)
        };
        axis.check(place, keys)?;
        if axes.combine == CombineSpec::OneAtATime {
            let keys = axis.keys();
            let has_value = |key: &String| {
                find(table.get_ref(), key).is_some_and(|own| own.get_ref().as_array().is_none())
            };
            if axis.has_column && !keys.iter().all(has_value) {
                let allowed =
                    "one value in its table, from which the axes are varied one at a time";
                return Err(axis.error(place, "none or several values in its table", allowed));
            }
            axes.axes.push(axis);
            continue;
        }
        let value = match value.into_inner() {
            DeValue::Array(values) if !axis.has_column => values[0].clone(),
            list => Spanned::new(0..0, list),
        };
        for key in axis.keys() {
            if insert(table.get_mut(), &key, (start, value.clone())).is_none() {
                let given = "given here and in its table";
                return Err(axis.error(place, given, "one of the two"));
            }
        }
        if !axis.has_column {
            axes.axes.push(axis);
        }
    }
    let study = S::deserialize(toml::Deserializer::from(table));
    let study = study.map_err(|error| {
        unexpected_list(place, text, &error, keys).unwrap_or_else(|| said(error))
    })?;
    Ok((study, axes))
}

/// Returns an error that states where a list is allowed, if a reader refused the list of a key that has one value in its table; otherwise `None`.
fn unexpected_list(
    place: &str,
    text: &str,
    error: &toml::de::Error,
    keys: &[KeyAbout],
) -> Option<Error> {
    let span = error.span()?;
    // A reader that accepts values of several types describes them in words.
    let said = error.message().trim();
    let expected = said.strip_prefix("invalid type: sequence, expected ");
    let is_plain = said.starts_with("wanted ") || expected.is_some_and(|e| !e.contains(", or "));
    if !is_plain || !text.get(span.clone())?.starts_with('[') {
        return None;
    }
    let table = DeTable::parse(text).ok()?;
    let is_refused = |about: &&KeyAbout| {
        find(table.get_ref(), about.path).is_some_and(|value| value.span() == span)
    };
    let mut keys = keys.iter().filter(|about| about.axis != AxisPlace::Table);
    let about = keys.find(is_refused)?;
    let allowed = match about.axis {
        AxisPlace::Axes => format!(
            "one value, or several as an axis: [axes] {:?} = {}",
            about.path,
            &text[span.clone()]
        ),
        _ => "one value: this key cannot be an axis".to_owned(),
    };
    let line = line_of(text, span.start);
    Some(Error::input(
        format!("{place}:{line}, key {}", about.path),
        "a list",
        allowed,
    ))
}

/// Returns all lists in a TOML table and its subtables, each with its dotted key path and its start position in the text.
fn leaves<'i>(
    prefix: String,
    table: DeTable<'i>,
    found: &mut Vec<(String, usize, Spanned<DeValue<'i>>)>,
) {
    for (name, value) in table {
        let key = format!("{prefix}{}", name.get_ref());
        let (start, span) = (name.span().start, value.span());
        match value.into_inner() {
            DeValue::Table(inner) => leaves(format!("{key}."), inner, found),
            value => found.push((key, start, Spanned::new(span, value))),
        }
    }
}

/// Removes the key `combine` from the keys of `[axes]` and returns its value.
fn take_combine(
    place: &str,
    text: &str,
    found: &mut Vec<(String, usize, Spanned<DeValue>)>,
) -> Result<CombineSpec> {
    let Some(index) = found.iter().position(|(key, ..)| key == "combine") else {
        return Ok(CombineSpec::default());
    };
    let (_, _, value) = found.remove(index);
    let value = toml::de::ValueDeserializer::from(value);
    CombineSpec::deserialize(value).map_err(|error| Error::toml(place, text, &error))
}

/// Returns the values of a TOML list, or an empty list for any other value.
fn list(place: &str, text: &str, value: &Spanned<DeValue>) -> Result<Vec<toml::Value>> {
    let DeValue::Array(values) = value.get_ref() else {
        return Ok(Vec::new());
    };
    let values = values.iter().map(|value| {
        let value = toml::de::ValueDeserializer::from(value.clone());
        toml::Value::deserialize(value).map_err(|error| Error::toml(place, text, &error))
    });
    values.collect()
}

/// Returns the TOML value at a dotted key path; `None` if the path does not exist.
fn find<'t, 'i>(table: &'t DeTable<'i>, key: &str) -> Option<&'t Spanned<DeValue<'i>>> {
    match key.split_once('.') {
        None => table.get(key),
        Some((first, rest)) => find(table.get(first)?.get_ref().as_table()?, rest),
    }
}

/// Inserts a TOML value at a dotted key path, with `start` as its position in the text. Returns `None` if the path already has a value or a part of it is not a
/// table.
fn insert<'i>(
    table: &mut DeTable<'i>,
    key: &str,
    (start, value): (usize, Spanned<DeValue<'i>>),
) -> Option<()> {
    let name = |name: &str| Spanned::new(start..start, Cow::Owned(name.to_owned()));
    let Some((first, rest)) = key.split_once('.') else {
        return table.insert(name(key), value).is_none().then_some(());
    };
    let empty = || Spanned::new(start..start, DeValue::Table(DeTable::new()));
    match table.entry(name(first)).or_insert_with(empty).get_mut() {
        DeValue::Table(inner) => insert(inner, rest, (start, value)),
        _ => None,
    }
}

impl StudyAxis {
    /// Creates an axis from a key path and values that do not come from a study file.
    fn new(key: String, values: Vec<toml::Value>, known: &'static [KeyAbout]) -> Self {
        let mut axis = Self {
            key,
            about: None,
            has_column: false,
            values,
            line: None,
        };
        let keys = axis.keys();
        axis.about = keys
            .first()
            .and_then(|key| find_key(known, without_test(key)));
        axis.has_column = axis
            .about
            .is_some_and(|about| about.axis == AxisPlace::Table && about.path == axis.key);
        axis
    }

    /// Returns an error about an axis, with file, line and key of the axis.
    fn error(&self, place: &str, given: impl ToString, allowed: impl ToString) -> Error {
        let line = self.line.map_or(String::new(), |line| format!(":{line}"));
        let place = format!("{place}{line}, axes.{:?}", self.key);
        Error::input(place, given, allowed)
    }

    fn check(&self, place: &str, known: &[KeyAbout]) -> Result<()> {
        let keys = self.keys();
        let refused = keys
            .iter()
            .find(|key| find_key(known, key).is_some_and(|about| about.axis == AxisPlace::Never));
        let is_path =
            |key: &String| !key.split('.').any(str::is_empty) && !key.contains(['{', '}']);
        let twice = self.values.iter().enumerate().find(|(place, value)| {
            let before = self.values[..*place].iter();
            before.take(MAX_VALUES).any(|other| is_same(other, value))
        });
        let n = self.values.len();
        let (given, allowed) = match (refused, twice) {
            (Some(key), _) => (
                format!("{key} as an axis"),
                "a key that may differ within a study",
            ),
            _ if !keys.iter().all(is_path) => (
                "no path".to_owned(),
                "the path of a key: \"skin.stroke_mm\", or of several: \"touches.offset_{x,y}_mm\"",
            ),
            _ if n == 0 => (
                "no list of values".to_owned(),
                "at least one value: [1.0, 2.0]",
            ),
            _ if n > MAX_VALUES => (format!("{n} values"), "at most 10000 values"),
            (_, Some((_, value))) => (format!("{value} twice"), "each value once"),
            _ => return Ok(()),
        };
        Err(self.error(place, given, allowed))
    }

    /// Returns the paths of all keys that the axis sets: several if the axis key lists several names in braces.
    pub fn keys(&self) -> Vec<String> {
        let parts = self.key.split_once('{').and_then(|(start, rest)| {
            let (names, end) = rest.split_once('}')?;
            Some((start, names.split(','), end))
        });
        match parts {
            None => vec![self.key.clone()],
            Some((start, names, end)) => {
                let keys = names.map(|name| format!("{start}{}{end}", name.trim()));
                keys.collect()
            }
        }
    }

    /// Returns the key path of the axis without braces and without a last part that only selects a distribution.
    fn path(&self) -> String {
        let path = self.key.replace(['{', '}', ',', ' '], "");
        path.strip_suffix(".within").unwrap_or(&path).to_owned()
    }

    /// Returns the preferred name of the axis's table column: the last part of the key path, with `test_` before keys of test touches.
    fn name(&self) -> String {
        let path = self.path();
        let last = path.rsplit('.').next().unwrap_or(&path);
        match self.is_of_tests() {
            true => format!("test_{last}"),
            false => last.to_owned(),
        }
    }

    /// Returns the column of the axis in result tables. For a name that another column already has, `is_taken` returns true.
    pub fn column(&self, is_taken: impl Fn(&str) -> bool) -> Column {
        let last = self.name();
        let last = &last[..];
        let name = match is_taken(last) {
            true => self.path().replace('.', "_"),
            false => last.to_owned(),
        };
        // The name is leaked, because the names of columns must be `'static`.
        let name: &'static str = name.leak();
        let numbers: Option<Vec<f64>> = self.values.iter().map(number).collect();
        let scale = scale(numbers);
        let Some(about) = self.about else {
            return Column::new(name, Role::Choice, last.replace('_', " "), "", scale).optional();
        };
        let (role, words) = match self.is_of_tests() {
            true => (Role::Condition, format!("test {}", about.title())),
            false => (about.role, about.title()),
        };
        let column = Column::new(
            name,
            role,
            words,
            about.unit(),
            about.scale.unwrap_or(scale),
        );
        column.named(about.names.unwrap_or_default()).optional()
    }

    /// Returns the value of this axis's key in a study. Returns `None` if the study has no value there, or a value of another type.
    fn own(&self, study: &toml::Table) -> Option<toml::Value> {
        let own = value_at(study, self.keys().first()?)?;
        let is_number = self.values.iter().all(|value| number(value).is_some());
        (!is_number || number(own).is_some()).then(|| own.clone())
    }

    /// Returns whether every key of the axis has the given value in a study.
    fn is_at(&self, study: &toml::Table, value: &toml::Value) -> bool {
        let has = |key: &String| value_at(study, key).is_some_and(|own| is_same(own, value));
        self.keys().iter().all(has)
    }

    /// Returns whether the key of the axis applies only to test touches.
    fn is_of_tests(&self) -> bool {
        self.key.starts_with(OF_TESTS)
    }
}

/// Prefix of keys that apply only to test touches.
const OF_TESTS: &str = "test.";

/// Returns the path of a key without the prefix `test.`, which marks keys of test touches.
fn without_test(key: &str) -> &str {
    key.strip_prefix(OF_TESTS).unwrap_or(key)
}

/// Minimum ratio of the largest to the smallest value of a swept key for which charts use a logarithmic axis. If larger, the small values of a sweep by
/// powers of two overlap on a linear axis. If smaller, evenly spaced values are drawn unevenly. Zero is drawn separately.
const LOG_FROM: f64 = 16.0;

/// Returns whether two TOML values are equal; an integer and a float of the same size count as equal.
fn is_same(one: &toml::Value, other: &toml::Value) -> bool {
    match (number(one), number(other)) {
        (Some(one), Some(other)) => one == other,
        _ => one == other,
    }
}

fn scale(numbers: Option<Vec<f64>>) -> Scale {
    let Some(numbers) = numbers else {
        return Scale::Words;
    };
    let positive = numbers.iter().copied().filter(|&number| number > 0.0);
    let least = positive.fold(f64::INFINITY, f64::min);
    let most = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let is_negative = numbers.iter().any(|&number| number < 0.0);
    match !is_negative && most / least >= LOG_FROM {
        true => Scale::Log,
        false => Scale::Linear,
    }
}

impl StudyAxes {
    /// Returns whether the study has no axes.
    pub fn is_empty(&self) -> bool {
        self.axes.is_empty()
    }

    /// Returns whether an axis varies the given key.
    pub fn has(&self, key: &str) -> bool {
        let mut axes = self.axes.iter();
        axes.any(|axis| axis.keys().iter().any(|own| own == key))
    }

    /// Returns one column for each axis that has no column in result tables yet. For a name that another column already has, `is_taken` returns true.
    pub fn columns(&self, is_taken: impl Fn(&str) -> bool) -> Vec<Column> {
        let column = |axis: &StudyAxis| {
            let alike = self.axes.iter().filter(|other| other.name() == axis.name());
            let is_shared = alike.count() > 1;
            axis.column(|name| is_shared || is_taken(name))
        };
        let shown = self.axes.iter().filter(|axis| !axis.has_column);
        shown.map(column).collect()
    }

    /// Returns the number of combinations of axis values that become configurations.
    pub fn n_combinations(&self) -> f64 {
        let lengths = self.axes.iter().map(|axis| axis.values.len() as f64);
        match self.combine {
            CombineSpec::All => lengths.product(),
            CombineSpec::OneAtATime => 1.0 + lengths.sum::<f64>(),
        }
    }

    /// Returns all combinations of axis values that become configurations; the last axis changes fastest. An entry of `None` means that the axis keeps its
    /// value in `study`.
    fn combinations(&self, study: &toml::Table) -> Vec<Vec<Option<toml::Value>>> {
        if self.combine == CombineSpec::OneAtATime {
            let mut all = vec![vec![None; self.axes.len()]];
            for (place, axis) in self.axes.iter().enumerate() {
                let others = axis.values.iter().filter(|value| !axis.is_at(study, value));
                all.extend(others.map(|value| {
                    let mut values = vec![None; self.axes.len()];
                    values[place] = Some(value.clone());
                    values
                }));
            }
            return all;
        }
        let mut all = vec![Vec::new()];
        for axis in &self.axes {
            let longer = all.iter().flat_map(|values: &Vec<Option<toml::Value>>| {
                let with = |value: &toml::Value| [&values[..], &[Some(value.clone())]].concat();
                axis.values.iter().map(with)
            });
            all = longer.collect();
        }
        all
    }

    /// Returns one study for each combination of axis values, together with these values. If an axis keeps its value, the listed value is the value in `study`.
    ///
    /// # Errors
    /// If a value is invalid for the study; the error names the axis.
    pub fn variants<S: Serialize + DeserializeOwned>(
        &self,
        place: &str,
        study: &S,
    ) -> Result<Vec<(Vec<Option<toml::Value>>, S)>> {
        let base = toml::Table::try_from(study).expect("every field of a study has a TOML form");
        let all = self.combinations(&base).into_iter().map(|mut values| {
            let mut table = base.clone();
            for (axis, value) in self.axes.iter().zip(&mut values) {
                let Some(value) = value else {
                    *value = axis.own(&base);
                    continue;
                };
                for key in axis.keys() {
                    let with = with_value(&table, &key, value.clone());
                    table = with.map_err(|error| axis.error(place, &*value, error))?;
                }
            }
            let study = table.try_into();
            let study = study.map_err(|error: toml::de::Error| {
                let said = error.to_string().trim().replace('\n', " ");
                self.refused(place, &values, &said)
            })?;
            Ok((values, study))
        });
        all.collect()
    }

    /// Returns the error about a combination of axis values that the study's checks reject. The error names the axes whose keys the message `said` mentions, or
    /// all axes.
    pub fn refused(&self, place: &str, values: &[Option<toml::Value>], said: &str) -> Error {
        let all = || {
            let axes = self.axes.iter().zip(values);
            axes.filter_map(|(axis, value)| Some((axis, value.as_ref()?)))
        };
        let names = |axis: &StudyAxis| axis.keys().iter().any(|key| said.contains(key));
        let mut named: Vec<_> = all().filter(|(axis, _)| names(axis)).collect();
        if named.is_empty() {
            named = all().collect();
        }
        let given = |(axis, value): &(&StudyAxis, &toml::Value)| format!("{} = {value}", axis.key);
        let given: Vec<String> = named.iter().map(given).collect();
        let said = said.strip_prefix(place).unwrap_or(said);
        let said = said.trim_start_matches([',', ':', ' ']);
        match named.first() {
            Some((axis, _)) => axis.error(place, given.join(", "), said),
            None => Error::input(place, "a study", said),
        }
    }
}

/// Returns a study as TOML without the keys of its axes, followed by its table `[axes]`.
pub fn to_toml<S: Serialize>(study: &S, axes: &StudyAxes) -> String {
    const HAS_FORM: &str = "every field of a study has a TOML form";
    if axes.is_empty() {
        return toml::to_string(study).expect(HAS_FORM);
    }
    let mut table = toml::Table::try_from(study).expect(HAS_FORM);
    let mut lines = "\n[axes]\n".to_owned();
    if axes.combine == CombineSpec::OneAtATime {
        lines.push_str("combine = \"one_at_a_time\"\n");
    }
    for axis in &axes.axes {
        for key in axis.keys() {
            if axes.combine == CombineSpec::All
                && let Some((inner, last)) = table_at(&mut table, &key)
            {
                inner.remove(last);
            }
        }
        let values = toml::Value::Array(axis.values.clone());
        lines.push_str(&format!("{:?} = {values}\n", axis.key));
    }
    toml::to_string(&table).expect(HAS_FORM) + &lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inputs::keys::keys;
    use crate::inputs::range::Range;

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Study {
        seed: u64,
        #[serde(default)]
        ratio: Vec<f64>,
        skin: Skin,
    }

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Skin {
        stroke_mm: f64,
        #[serde(default)]
        words: String,
    }

    const KEYS: &[KeyAbout] = keys! {
        "ratio": Table, Choice, Range::Any;
        "report": Never, Note, Range::Any;
    };

    const TEXT: &str = "[axes]\n\"skin.stroke_mm\" = [5.0, 1]\nseed = [3, 1]\nratio = [1.0, 4.0]\n[skin]\nwords = \"a\"\n";

    fn said(text: &str) -> String {
        let read = read::<Study>("s.toml", text, KEYS);
        let made = read.and_then(|(study, axes)| axes.variants("s.toml", &study));
        let error = made.unwrap_err();
        assert_eq!(error.exit_code(), 2);
        error.to_string()
    }

    #[test]
    fn every_combination_is_a_study_and_the_first_axis_changes_slowest() {
        let (study, axes) = read::<Study>("s.toml", TEXT, KEYS).unwrap();
        assert_eq!(study.ratio, [1.0, 4.0]);
        let variants = axes.variants("s.toml", &study).unwrap();
        let found = variants
            .iter()
            .map(|(_, study)| (study.skin.stroke_mm, study.seed));
        let found: Vec<(f64, u64)> = found.collect();
        assert_eq!(found, [(5.0, 3), (5.0, 1), (1.0, 3), (1.0, 1)]);
        assert!(
            variants
                .iter()
                .all(|(_, study)| study.skin.words == "a" && study.ratio.len() == 2)
        );
        assert_eq!(axes.n_combinations(), 4.0);
    }

    #[test]
    fn a_study_with_axes_reads_back_from_what_it_is_written_as() {
        let (study, axes) = read::<Study>("s.toml", TEXT, KEYS).unwrap();
        let text = to_toml(&study, &axes);
        let (again, same) = read::<Study>("s.toml", &text, KEYS).unwrap();
        let keys = |axes: &StudyAxes| -> Vec<(String, Vec<toml::Value>)> {
            let axes = axes.axes.iter();
            axes.map(|axis| (axis.key.clone(), axis.values.clone()))
                .collect()
        };
        assert_eq!((again, keys(&same)), (study, keys(&axes)), "{text}");
    }

    #[test]
    fn an_axis_that_cannot_be_is_told_with_its_line_and_what_is_allowed() {
        let with = |axis: &str| format!("seed = 1\n\n[axes]\n{axis}\n[skin]\nwords = \"a\"\n");
        for (text, wanted) in [
            (
                with("\"skin.stroke_mm\" = []"),
                "s.toml:4, axes.\"skin.stroke_mm\": no list",
            ),
            (with("skin.stroke_mm = 2.0"), "at least one value"),
            (
                with("skin.stroke_mm = [1, 2, 1.0]"),
                "1.0 twice; each value once",
            ),
            (
                with("skin.stroke_mm = [1.0]\nseed = [1, 2]"),
                "s.toml:5, axes.\"seed\": given here and in its table",
            ),
            (
                with("skin.stroke_mm = [1.0]\nskin.depth = [1.0, 2.0]"),
                "s.toml:5:6: unknown field `depth`",
            ),
            (
                with("skin.stroke_mm = [1.0]\nreport.pareto = [true, false]"),
                "report.pareto as an axis",
            ),
            (
                with("skin.stroke_mm = [1.0, \"a\"]"),
                "s.toml:4, axes.\"skin.stroke_mm\": skin.stroke_mm = \"a\"; invalid type",
            ),
            (
                with("skin.stroke_mm = [\"a\", 1.0]"),
                "s.toml:4:19: invalid type",
            ),
            (
                with("seed.more = [1]"),
                "axes.\"seed.more\": given here and in its table",
            ),
            ("axes = 3\n".to_owned(), "s.toml:1, key axes: no table"),
        ] {
            let said = said(&text);
            assert!(said.contains(wanted), "{said}\nis not\n{wanted}");
        }
    }

    #[test]
    fn a_value_at_a_path_takes_the_place_of_what_was_there() {
        let table: toml::Table = "a = 1\n[b]\nc = 2".parse().unwrap();
        let changed = with_value(&table, "b.c", 3.into()).unwrap();
        let expected = "a = 1\n[b]\nc = 3".parse().unwrap();
        assert_eq!(changed, expected);
        let made = with_value(&table, "d.e.f", true.into()).unwrap();
        assert_eq!(made["d"]["e"]["f"].as_bool(), Some(true));
        for key in ["a.b", "", "a..b", ".a", "b."] {
            let error = with_value(&table, key, 3.into()).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{key}");
        }
    }

    #[test]
    fn a_column_has_the_description_of_its_key_and_a_taken_name_its_whole_path() {
        const KEYS: &[KeyAbout] = keys! {
            "skin.stiffness_n_per_m": Axes, Choice, Range::Positive;
            "skin.friction": Axes, Condition, Range::NotNegative;
            "touches.frames": Table, Choice, Range::AtLeastOne, title: "frames a touch", scale: Scale::Log;
            "touches.depth_mm": Axes, Choice, Range::Positive;
            "recognition.solver": Axes, Choice, Range::Any;
        };
        let axis = |key: &str, values: &str| {
            let table: toml::Table = format!("v = {values}").parse().unwrap();
            StudyAxis::new(key.to_owned(), table["v"].as_array().unwrap().clone(), KEYS)
        };
        let column = |key: &str, values: &str| axis(key, values).column(|name| name == "frames");
        for (key, values, name, title, role, scale) in [
            (
                "touches.depth_mm",
                "[1.0, 2, 4]",
                "depth_mm",
                "depth (mm)",
                Role::Choice,
                Scale::Linear,
            ),
            (
                "touches.depth_mm.within",
                "[1, 16]",
                "depth_mm",
                "depth (mm)",
                Role::Choice,
                Scale::Log,
            ),
            (
                "test.touches.depth_mm",
                "[1, 2]",
                "test_depth_mm",
                "test depth (mm)",
                Role::Condition,
                Scale::Linear,
            ),
            (
                "touches.frames",
                "[1, 2]",
                "touches_frames",
                "frames a touch",
                Role::Choice,
                Scale::Log,
            ),
            (
                "skin.stiffness_n_per_m",
                "[10, 1000]",
                "stiffness_n_per_m",
                "stiffness (N/m)",
                Role::Choice,
                Scale::Log,
            ),
            (
                "skin.friction",
                "[0.0, 1.0]",
                "friction",
                "friction",
                Role::Condition,
                Scale::Linear,
            ),
            (
                "recognition.solver",
                "[\"smo\"]",
                "solver",
                "solver",
                Role::Choice,
                Scale::Words,
            ),
            (
                "other.a_b",
                "[1]",
                "a_b",
                "a b",
                Role::Choice,
                Scale::Linear,
            ),
        ] {
            let column = column(key, values);
            let found = (
                &column.name[..],
                &column.title()[..],
                column.role,
                column.scale,
            );
            assert_eq!(found, (name, title, role, scale), "{key}");
        }
        assert!(axis("touches.frames", "[1]").has_column);
        assert!(!axis("test.touches.frames", "[1]").has_column);
        assert!(!axis("touches.{frames,depth_mm}", "[1]").has_column);
    }
}
