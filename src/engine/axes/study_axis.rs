//! Axis of a study: the varied key, its values, and its column in result tables.

use crate::error::{Error, Result};
use crate::inputs::check::MAX_VALUES;
use crate::inputs::keys::{AxisPlace, KeyAbout, find as find_key};
use crate::inputs::toml_value::{number, value_at};
use crate::inputs::units::{MM, millimetres};
use crate::table::{Column, Role, Scale};

/// Prefix of keys that apply only to test touches.
const OF_TESTS: &str = "test.";

/// Minimum ratio of the largest to the smallest value of a swept key for which charts use a logarithmic axis. If larger, the small values of a sweep by
/// powers of two overlap on a linear axis. If smaller, evenly spaced values are drawn unevenly. Zero is drawn separately.
const LOG_FROM: f64 = 16.0;

/// Axis of a study: a key of the study file that is varied, and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyAxis {
    /// Path of the key, such as `touches.depth_mm`, or `touches.offset_{x,y}_mm` for two keys.
    pub key: String,
    /// Descriptions of the keys that are varied together; empty if a key has none. For keys of test touches, the descriptions of the keys without `test.`.
    pub about: Vec<&'static KeyAbout>,
    /// Whether result tables already contain a column with the values of this key.
    pub has_column: bool,
    /// Whether the list of values is in the table of the key, not in `[axes]`.
    pub is_of_table: bool,
    /// Distinct values of the axis, at least one.
    pub values: Vec<toml::Value>,
    /// Line number of the key in the study file; `None` if the axis does not come from a file.
    pub line: Option<usize>,
}

impl StudyAxis {
    /// Creates an axis from a key path and values that do not come from a study file.
    pub(super) fn new(key: String, values: Vec<toml::Value>, known: &'static [KeyAbout]) -> Self {
        let mut axis = Self {
            key,
            about: Vec::new(),
            has_column: false,
            is_of_table: false,
            values,
            line: None,
        };
        let keys = axis.keys();
        let about = keys.iter().map(|key| find_key(known, without_test(key)));
        axis.about = about.collect::<Option<_>>().unwrap_or_default();
        let own = axis.table_key();
        axis.has_column = own.is_some_and(|about| !about.is_swept_in_table);
        axis
    }

    /// Returns the key of the axis if its values may also be a list in its own table.
    pub(super) fn table_key(&self) -> Option<&'static KeyAbout> {
        let mut about = self.about.iter().copied();
        about.find(|about| about.axis == AxisPlace::Table && about.path == self.key)
    }

    /// Returns an error about an axis, with file, line and key of the axis.
    pub(super) fn error(&self, place: &str, given: impl ToString, allowed: impl ToString) -> Error {
        let line = self.line.map_or(String::new(), |line| format!(":{line}"));
        let key = match self.is_of_table {
            true => format!("key {}", self.key),
            false => format!("axes.{:?}", self.key),
        };
        Error::input(format!("{place}{line}, {key}"), given, allowed)
    }

    pub(super) fn check(&self, place: &str, known: &[KeyAbout]) -> Result<()> {
        let keys = self.keys();
        let refused = keys.iter().find_map(|key| {
            let about = find_key(known, key)?;
            (about.axis == AxisPlace::Never).then_some((key, about))
        });
        let is_path =
            |key: &String| !key.split('.').any(str::is_empty) && !key.contains(['{', '}']);
        let twice = self.values.iter().enumerate().find(|(place, value)| {
            let before = self.values[..*place].iter();
            before
                .take(MAX_VALUES)
                .any(|other| is_same(&self.shown(other), &self.shown(value)))
        });
        let n = self.values.len();
        let (given, allowed) = match (refused, twice) {
            (Some((key, about)), _) => (
                format!("{key} as an axis"),
                match about.role {
                    Role::Subject => {
                        "one value: trials = N repeats each configuration with other random draws"
                    }
                    _ => "a key that may differ within a study",
                },
            ),
            _ if !keys.iter().all(is_path) => (
                "no path".to_owned(),
                "the path of a key: \"skin.stroke_mm\", or of several: \"touches.offset_{x,y}_mm\"",
            ),
            _ if n == 0 && self.is_of_table => ("an empty list".to_owned(), "at least one value"),
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

    /// Returns a value as tables show it. Two values with equal text in tables would be mistaken for each other.
    fn shown(&self, value: &toml::Value) -> toml::Value {
        match number(value) {
            Some(mm) if self.is_of_table && self.key.ends_with("_mm") => {
                millimetres(mm * MM).into()
            }
            _ => value.clone(),
        }
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

    /// Returns the key path of the axis without braces and without a last part that only selects a distribution. Single letters in braces are joined (`xy`),
    /// names by `_`.
    fn path(&self) -> String {
        let names = self.key.split(['{', '}']).nth(1).unwrap_or_default();
        let is_letter = |name: &str| name.trim().len() == 1;
        let between = if names.split(',').all(is_letter) {
            ""
        } else {
            "_"
        };
        let path = self.key.replace(['{', '}', ' '], "").replace(',', between);
        path.strip_suffix(".within").unwrap_or(&path).to_owned()
    }

    /// Returns the preferred name of the axis's table column: the last part of the key path, with `test_` before keys of test touches.
    pub(super) fn name(&self) -> String {
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
        let [about, others @ ..] = &self.about[..] else {
            return Column::new(name, Role::Choice, last.replace('_', " "), "", scale).optional();
        };
        let titles: Vec<String> = self.about.iter().map(|about| about.title()).collect();
        let titles = titles.join(" and ");
        // Keys that are varied together are a condition if one of them is.
        let is_condition = self.about.iter().any(|about| about.role == Role::Condition);
        let (role, words) = match self.is_of_tests() {
            true => (Role::Condition, format!("test {titles}")),
            false if is_condition => (Role::Condition, titles),
            false => (about.role, titles),
        };
        let is_alike = others.iter().all(|other| other.unit() == about.unit());
        let unit = if is_alike { about.unit() } else { "" };
        let column = Column::new(name, role, words, unit, about.scale.unwrap_or(scale));
        column.named(about.names.unwrap_or_default()).optional()
    }

    /// Returns the value of this axis's keys in a study. Returns `None` if the study has no value there, a value of another type, or different values for several
    /// keys.
    pub(super) fn own(&self, study: &toml::Table) -> Option<toml::Value> {
        let own = value_at(study, self.keys().first()?)?;
        let is_number = self.values.iter().all(|value| number(value).is_some());
        let is_own = (!is_number || number(own).is_some()) && self.is_at(study, own);
        is_own.then(|| own.clone())
    }

    /// Returns whether every key of the axis has the given value in a study.
    pub(super) fn is_at(&self, study: &toml::Table, value: &toml::Value) -> bool {
        let has = |key: &String| value_at(study, key).is_some_and(|own| is_same(own, value));
        self.keys().iter().all(has)
    }

    /// Returns whether the key of the axis applies only to test touches.
    fn is_of_tests(&self) -> bool {
        self.key.starts_with(OF_TESTS)
    }
}

/// Returns the path of a key without the prefix `test.`, which marks keys of test touches.
fn without_test(key: &str) -> &str {
    key.strip_prefix(OF_TESTS).unwrap_or(key)
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::recognition::spec::keys::recognition_keys;

    #[test]
    fn a_column_has_the_description_of_its_key_and_a_taken_name_its_whole_path() {
        let axis = |key: &str, values: &str| {
            let table: toml::Table = format!("v = {values}").parse().unwrap();
            StudyAxis::new(
                key.to_owned(),
                table["v"].as_array().unwrap().clone(),
                recognition_keys(),
            )
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
                "touches.offset_{x,y}_mm",
                "[1, 2]",
                "offset_xy_mm",
                "offset x and offset y (mm)",
                Role::Condition,
                Scale::Linear,
            ),
            (
                "touches.{depth_mm,offset_x_mm}",
                "[1, 2]",
                "depth_mm_offset_x_mm",
                "depth and offset x (mm)",
                Role::Condition,
                Scale::Linear,
            ),
            (
                "skin.{stiffness_n_per_m,friction}",
                "[1, 2]",
                "stiffness_n_per_m_friction",
                "stiffness and friction",
                Role::Condition,
                Scale::Linear,
            ),
            (
                "sensing.readings_per_s",
                "[1, 2]",
                "readings_per_s",
                "readings (1/s)",
                Role::Choice,
                Scale::Linear,
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
