//! `[axes]`: any key of a study with the values that it takes one after the other, in all combinations.
//!
//! ```toml
//! [axes]
//! "touches.depth_mm" = [1.0, 2.0, 4.0]
//! "skin.stiffness_n_per_m" = [500.0, 2000.0]
//! ```
//! The key stands here in place of its own table. Each combination is a study of its own, checked as any study is; a key that takes a list
//! where it stands is an axis there, and may be written in either place.

use crate::error::{Error, Result};
use crate::inputs::check::MOST_VALUES;
use crate::inputs::toml_value::{is_at, number};
use crate::table::{Column, Role, Scale};
use crate::toml_lines::line_of;
use crate::toml_text::{check_brackets, check_numbers};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// What a study may say in `[axes]`.
#[derive(Clone, Copy, Debug)]
pub struct AxisRules {
    /// Keys that take a list where they stand: given in `[axes]`, they are put there.
    pub in_place: fn(&str) -> bool,
    /// Keys that cannot differ within a study, with all below them.
    pub refused: &'static [&'static str],
}

/// The axes that a study names itself, the first changing slowest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyAxes(pub Vec<StudyAxis>);

/// A key and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyAxis {
    /// Its path: `touches.depth_mm`.
    pub key: String,
    /// At least one, each once.
    pub values: Vec<toml::Value>,
    /// The line of the file on which it stands; none of an axis that no file has.
    pub line: Option<usize>,
}

/// Where a configuration is on the axes of its study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisValues {
    /// The number of the combination, from 0.
    pub number: usize,
    /// The value on each axis.
    pub values: Arc<[AxisValue]>,
}

impl AxisValues {
    /// Of a combination, in tables whose columns are these.
    pub fn new(number: usize, columns: &[Column], values: &[toml::Value]) -> Self {
        use toml::Value::{Boolean, Float, Integer, String};
        let values = columns.iter().zip(values);
        let values = values.map(|(column, value)| AxisValue {
            column: column.clone(),
            value: match value {
                Integer(_) | Float(_) | Boolean(_) | String(_) => value.clone(),
                other => other.to_string().into(),
            },
        });
        Self {
            number,
            values: values.collect(),
        }
    }
}

/// A value on an axis, as tables have it.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisValue {
    /// What the axis is.
    pub column: Column,
    /// A number, a truth value, or a text; a list or a table is the text of it.
    pub value: toml::Value,
}

/// The table in which the last key of a path stands, made with those on the way where there is none, and that key; none through something
/// that is no table.
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

/// A table with a value at a path of keys, in place of what was there; tables on the way are made.
///
/// # Errors
/// A path without a key, or through something that is no table.
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

/// A study and its axes; in the study each of their keys has its first value, but keys of lists have all.
///
/// # Errors
/// What the study's reader refuses; an axis without values, with one twice, of a key that is given elsewhere too or that cannot be an
/// axis. Each names file, line and key.
pub fn read<S: DeserializeOwned>(
    place: &str,
    text: &str,
    rules: AxisRules,
) -> Result<(S, StudyAxes)> {
    check_brackets(place, text)?;
    check_numbers(place, text)?;
    let said = |error| Error::toml(place, text, &error);
    let mut table = DeTable::parse(text).map_err(said)?;
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
    // In the order in which they are written.
    found.sort_by_key(|(_, start, _)| *start);
    let mut axes = StudyAxes::default();
    for (key, start, value) in found {
        let line = line_of(text, start);
        let axis = StudyAxis {
            values: list(place, text, &value)?,
            key,
            line: Some(line),
        };
        axis.check(place, rules)?;
        let is_in_place = (rules.in_place)(&axis.key);
        let value = match value.into_inner() {
            DeValue::Array(values) if !is_in_place => values[0].clone(),
            list => Spanned::new(0..0, list),
        };
        if insert(table.get_mut(), &axis.key, (start, value)).is_none() {
            let given = "given here and in its table";
            return Err(axis.error(place, given, "one of the two"));
        }
        if !is_in_place {
            axes.0.push(axis);
        }
    }
    let study = S::deserialize(toml::Deserializer::from(table)).map_err(said)?;
    Ok((study, axes))
}

/// The lists below a table, by their paths and where they begin.
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

/// The values of a list; of anything else none.
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

/// Puts a value, written from `start` on, at a path where none is; `None` if there is one, or no table on the way.
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
    /// An error about it: file, line and key first.
    fn error(&self, place: &str, given: impl ToString, allowed: impl ToString) -> Error {
        let line = self.line.map_or(String::new(), |line| format!(":{line}"));
        let place = format!("{place}{line}, axes.{:?}", self.key);
        Error::input(place, given, allowed)
    }

    fn check(&self, place: &str, rules: AxisRules) -> Result<()> {
        let refused = rules.refused.iter();
        let refused = refused.copied().find(|name| is_at(&self.key, name));
        let same = |one: &toml::Value, other: &toml::Value| match (number(one), number(other)) {
            (Some(one), Some(other)) => one == other,
            _ => one == other,
        };
        let twice = self.values.iter().enumerate().find(|(place, value)| {
            let before = self.values[..*place].iter();
            before.take(MOST_VALUES).any(|other| same(other, value))
        });
        let n = self.values.len();
        let (given, allowed) = match (refused, twice) {
            (Some(key), _) => (
                format!("{key} as an axis"),
                "a key that may differ within a study",
            ),
            _ if self.key.split('.').any(str::is_empty) => (
                "no path".to_owned(),
                "the path of a key: \"skin.stroke_mm\"",
            ),
            _ if n == 0 => (
                "no list of values".to_owned(),
                "at least one value: [1.0, 2.0]",
            ),
            _ if n > MOST_VALUES => (format!("{n} values"), "at most 10000 values"),
            (_, Some((_, value))) => (format!("{value} twice"), "each value once"),
            _ => return Ok(()),
        };
        Err(self.error(place, given, allowed))
    }

    /// The key alone, without its tables.
    fn last(&self) -> &str {
        self.key.rsplit('.').next().unwrap_or(&self.key)
    }

    /// Its column in tables of results, where the names of others are taken.
    pub fn column(&self, is_taken: impl Fn(&str) -> bool) -> Column {
        let last = self.last();
        let name = match is_taken(last) {
            true => self.key.replace('.', "_"),
            false => last.to_owned(),
        };
        // It lives as long as the program, as names that are written there do: those of a row's fields must.
        let name: &'static str = name.leak();
        let found = UNITS.iter().find_map(|(suffix, unit)| {
            let words = last.strip_suffix(suffix)?;
            (!words.is_empty()).then_some((words, *unit))
        });
        let (words, unit) = found.unwrap_or((last, ""));
        let known = WORDS.iter().find(|(key, _)| *key == self.key);
        let words = known.map_or(words, |(_, known)| known);
        let mut words = words.replace('_', " ");
        if let (true, Some((table, _))) = (words.starts_with("per "), self.key.split_once('.')) {
            words = format!("{table} {words}");
        }
        let numbers: Option<Vec<f64>> = self.values.iter().map(number).collect();
        Column::new(name, self.role(), words, unit, scale(numbers)).optional()
    }

    fn role(&self) -> Role {
        let known = ROLES.iter().find(|(start, _)| self.key.starts_with(start));
        known.map_or(Role::Choice, |(_, role)| *role)
    }
}

/// Words of keys whose last word says too little.
const WORDS: [(&str, &str); 3] = [
    ("skin.sensed", "sensed quantity"),
    ("recognition.keep_together", "group held out"),
    ("recognition.split", "poses held out"),
];

/// Units by the ends of keys, longer ends first.
const UNITS: [(&str, &str); 15] = [
    ("_n_s_per_m", "N·s/m"),
    ("_mm_per_s", "mm/s"),
    ("_n_per_m", "N/m"),
    ("_deg", "°"),
    ("_gib", "GiB"),
    ("_mm", "mm"),
    ("_ms", "ms"),
    ("_hz", "Hz"),
    ("_kg", "kg"),
    ("_us", "µs"),
    ("_pa", "Pa"),
    ("_n", "N"),
    ("_m", "m"),
    ("_s", "s"),
    ("_g", "g"),
];

/// Roles by the beginnings of keys; all others are choices. How deep, how far along, how often and how fast one presses is chosen; where the
/// object lies, how it is turned and how slippery it is is not. How touches are split, in which groups, and what was recorded is a condition of the
/// experiment: a designer who could choose the split would choose the easiest.
const ROLES: [(&str, Role); 18] = [
    ("seed", Role::Subject),
    ("recorded.", Role::Condition),
    ("recognition.split", Role::Condition),
    ("recognition.keep_together", Role::Condition),
    ("recognition.test_fraction", Role::Condition),
    ("recognition.folds", Role::Condition),
    ("skin.friction", Role::Condition),
    ("touches.depth", Role::Choice),
    ("touches.slide", Role::Choice),
    ("touches.per_object", Role::Choice),
    ("touches.frames", Role::Choice),
    ("touches.speed", Role::Choice),
    ("touches.", Role::Condition),
    ("signal.smoothing", Role::Choice),
    ("signal.steps", Role::Choice),
    ("signal.", Role::Condition),
    ("human_touch.kinds", Role::Condition),
    ("objects.", Role::Condition),
];

/// From this ratio of the largest to the smallest on, numbers lie along an axis by their logarithm. Larger, and the small ones of a sweep
/// by powers of two lie on each other; smaller, and evenly spread ones look uneven.
const LOG_FROM: f64 = 16.0;

fn scale(numbers: Option<Vec<f64>>) -> Scale {
    let Some(numbers) = numbers else {
        return Scale::Words;
    };
    let least = numbers.iter().copied().fold(f64::INFINITY, f64::min);
    let most = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    match least > 0.0 && most / least >= LOG_FROM {
        true => Scale::Log,
        false => Scale::Linear,
    }
}

impl StudyAxes {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether a key is one of them.
    pub fn has(&self, key: &str) -> bool {
        self.0.iter().any(|axis| axis.key == key)
    }

    /// The column of each, where the names of others are taken.
    pub fn columns(&self, is_taken: impl Fn(&str) -> bool) -> Vec<Column> {
        let column = |axis: &StudyAxis| {
            let alike = self.0.iter().filter(|other| other.last() == axis.last());
            let is_shared = alike.count() > 1;
            axis.column(|name| is_shared || is_taken(name))
        };
        self.0.iter().map(column).collect()
    }

    /// How many combinations of values there are.
    pub fn n_combinations(&self) -> f64 {
        self.0.iter().map(|axis| axis.values.len() as f64).product()
    }

    /// Every combination of a value of each axis, the first axis changing slowest.
    pub fn combinations(&self) -> Vec<Vec<toml::Value>> {
        let mut all = vec![Vec::new()];
        for axis in &self.0 {
            let longer = all.iter().flat_map(|values: &Vec<toml::Value>| {
                let with =
                    |value: &toml::Value| [&values[..], std::slice::from_ref(value)].concat();
                axis.values.iter().map(with)
            });
            all = longer.collect();
        }
        all
    }

    /// Each combination of values with the study that has it: `study` with these at the axes' keys.
    ///
    /// # Errors
    /// A value that the study's reader refuses; the error names the axis.
    pub fn variants<S: Serialize + DeserializeOwned>(
        &self,
        place: &str,
        study: &S,
    ) -> Result<Vec<(Vec<toml::Value>, S)>> {
        let table = toml::Table::try_from(study).expect("every field of a study has a TOML form");
        let all = self.combinations().into_iter().map(|values| {
            let mut table = table.clone();
            for (axis, value) in self.0.iter().zip(&values) {
                let with = with_value(&table, &axis.key, value.clone());
                table = with.map_err(|error| axis.error(place, value, error))?;
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

    /// What is said of a combination that a check refuses: first the axes whose keys the check speaks of, or all of them.
    pub fn refused(&self, place: &str, values: &[toml::Value], said: &str) -> Error {
        let all = || self.0.iter().zip(values);
        let mut named: Vec<_> = all().filter(|(axis, _)| said.contains(&axis.key)).collect();
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

/// A study as TOML: without the keys of its axes, and with their table at its end, in their order.
pub fn to_toml<S: Serialize>(study: &S, axes: &StudyAxes) -> String {
    const HAS_FORM: &str = "every field of a study has a TOML form";
    if axes.is_empty() {
        return toml::to_string(study).expect(HAS_FORM);
    }
    let mut table = toml::Table::try_from(study).expect(HAS_FORM);
    let mut lines = "\n[axes]\n".to_owned();
    for StudyAxis { key, values, .. } in &axes.0 {
        if let Some((inner, last)) = table_at(&mut table, key) {
            inner.remove(last);
        }
        let values = toml::Value::Array(values.clone());
        lines.push_str(&format!("{:?} = {values}\n", key));
    }
    toml::to_string(&table).expect(HAS_FORM) + &lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Role;

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

    const RULES: AxisRules = AxisRules {
        in_place: |key| key == "ratio",
        refused: &["report"],
    };

    const TEXT: &str = "[axes]\n\"skin.stroke_mm\" = [5.0, 1]\nseed = [3, 1]\nratio = [1.0, 4.0]\n[skin]\nwords = \"a\"\n";

    fn said(text: &str) -> String {
        let read = read::<Study>("s.toml", text, RULES);
        let made = read.and_then(|(study, axes)| axes.variants("s.toml", &study));
        let error = made.unwrap_err();
        assert_eq!(error.exit_code(), 2);
        error.to_string()
    }

    #[test]
    fn every_combination_is_a_study_and_the_first_axis_changes_slowest() {
        let (study, axes) = read::<Study>("s.toml", TEXT, RULES).unwrap();
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
        let (study, axes) = read::<Study>("s.toml", TEXT, RULES).unwrap();
        let text = to_toml(&study, &axes);
        let (again, same) = read::<Study>("s.toml", &text, RULES).unwrap();
        let keys = |axes: &StudyAxes| -> Vec<(String, Vec<toml::Value>)> {
            let axes = axes.0.iter();
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
                "report as an axis",
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
    fn the_column_of_an_axis_says_its_unit_and_role_and_a_taken_name_its_whole_path() {
        let column = |key: &str, values: &str| {
            let text = format!("v = {values}");
            let table: toml::Table = text.parse().unwrap();
            let axis = StudyAxis {
                key: key.to_owned(),
                values: table["v"].as_array().unwrap().clone(),
                line: None,
            };
            axis.column(|name| name == "frames")
        };
        let depth = column("touches.depth_mm", "[1.0, 2, 4]");
        let shown = (&depth.name[..], depth.title(), depth.role, depth.scale);
        let expected = (
            "depth_mm",
            "depth (mm)".to_owned(),
            Role::Choice,
            Scale::Linear,
        );
        assert_eq!(shown, expected);
        let stiffness = column("skin.stiffness_n_per_m", "[10, 1000]");
        assert_eq!(
            (stiffness.title(), stiffness.scale),
            ("stiffness (N/m)".to_owned(), Scale::Log)
        );
        assert_eq!(
            column("human_touch.frames", "[1]").name,
            "human_touch_frames"
        );
        assert_eq!(column("seed", "[1]").role, Role::Subject);
        // How touches are split and what was recorded is no choice of a designer.
        for key in [
            "recognition.split",
            "recognition.keep_together",
            "recognition.keep_together_mm",
            "recognition.keep_together_deg",
            "recognition.test_fraction",
            "recognition.folds",
            "recorded.groups",
        ] {
            assert_eq!(column(key, "[\"a\"]").role, Role::Condition, "{key}");
        }
        assert_eq!(column("touches.rest", "[\"stable\"]").role, Role::Condition);
        assert_eq!(
            column("recognition.solver", "[\"smo\"]").scale,
            Scale::Words
        );
    }
}
