//! Reader and writer of the table `[axes]` of a study file.

use super::study_axes::{CombineSpec, StudyAxes, find, insert, table_at, take_list};
use super::study_axis::StudyAxis;
use crate::error::{Error, Result};
use crate::inputs::keys::{AxisPlace, KeyAbout};
use crate::inputs::toml_value::{number, table_of, value_at};
use crate::toml_lines::line_of;
use crate::toml_text::{TomlText, refused};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Reads a study file with its axes, after checking that it contains only allowed keys. A list of a key that has one value is an axis, in `[axes]` and in the
/// table of the key. In the returned study, each key of an axis has its first value; keys whose type takes a list have all values.
///
/// # Errors
/// If the study is invalid. If an axis has no values, a repeated value, a key that is also given elsewhere, or a key that cannot be an axis. The error names
/// the file, the line and the key.
pub fn read<S: DeserializeOwned + Serialize>(
    place: &str,
    text: &str,
    keys: &'static [KeyAbout],
) -> Result<(S, StudyAxes)> {
    let mut table = TomlText::parse(place, text)?.table;
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
        let values = list_of(place, text, &value)?;
        let axis = StudyAxis {
            line: Some(line),
            ..StudyAxis::new(key, values, keys)
        };
        axis.check(place, keys)?;
        if axes.combine == CombineSpec::OneAtATime {
            let own = find(table.get_ref(), &axis.key);
            let has_list = own.is_some_and(|own| own.get_ref().as_array().is_some());
            if axis.table_key().is_some() && (has_list || axis.has_column && own.is_none()) {
                let allowed =
                    "one value in its table, from which the axes are varied one at a time";
                return Err(axis.error(place, "none or several values in its table", allowed));
            }
            axes.axes.push(axis);
            continue;
        }
        let is_of_table = axis.table_key().is_some();
        let value = match value.into_inner() {
            DeValue::Array(values) if !is_of_table => values[0].clone(),
            list => Spanned::new(0..0, list),
        };
        for key in axis.keys() {
            if insert(table.get_mut(), &key, (start, value.clone())).is_none() {
                let given = "given here and in its table";
                return Err(axis.error(place, given, "one of the two"));
            }
        }
        if !is_of_table {
            axes.axes.push(axis);
        }
    }
    for about in keys.iter().filter(|about| about.is_swept_in_table) {
        let Some((start, list)) = take_list(table.get_mut(), about.path) else {
            continue;
        };
        let axis = StudyAxis {
            line: Some(line_of(text, start)),
            is_of_table: true,
            ..StudyAxis::new(about.path.to_owned(), list_of(place, text, &list)?, keys)
        };
        axis.check(place, keys)?;
        if let DeValue::Array(values) = list.into_inner() {
            insert(table.get_mut(), about.path, (start, values[0].clone()));
        }
        axes.axes.push(axis);
    }
    let study = S::deserialize(toml::Deserializer::from(table));
    let study = study.map_err(|error| {
        unexpected_list(place, text, &error, keys).unwrap_or_else(|| refused(place, text, &error))
    })?;
    let own = table_of(&study);
    for axis in axes.axes.iter_mut().filter(|axis| axis.is_of_table) {
        // Whole numbers of a key with decimals are written with decimals.
        if value_at(&own, &axis.key).is_some_and(toml::Value::is_float) {
            let as_float = |value: &mut toml::Value| {
                if let Some(number) = number(value) {
                    *value = number.into();
                }
            };
            axis.values.iter_mut().for_each(as_float);
        }
    }
    Ok((study, axes))
}

/// Returns a study as TOML without the keys of its axes, followed by its table `[axes]`.
pub fn to_toml<S: Serialize>(study: &S, axes: &StudyAxes) -> String {
    const HAS_FORM: &str = "every field of a study has a TOML form";
    if axes.is_empty() {
        return toml::to_string(study).expect(HAS_FORM);
    }
    let mut table = toml::Table::try_from(study).expect(HAS_FORM);
    let mut lines = String::new();
    if axes.has_own_table() {
        lines.push_str("\n[axes]\n");
    }
    if axes.combine == CombineSpec::OneAtATime {
        lines.push_str("combine = \"one_at_a_time\"\n");
    }
    for axis in &axes.axes {
        let values = toml::Value::Array(axis.values.clone());
        let is_kept = !axis.is_of_table && axes.combine == CombineSpec::OneAtATime;
        for key in axis.keys() {
            if !is_kept && let Some((inner, last)) = table_at(&mut table, &key) {
                match axis.is_of_table {
                    true => inner.insert(last.to_owned(), values.clone()),
                    false => inner.remove(last),
                };
            }
        }
        if !axis.is_of_table {
            lines.push_str(&format!("{:?} = {values}\n", axis.key));
        }
    }
    toml::to_string(&table).expect(HAS_FORM) + &lines
}

/// If a reader refused a list of a key that has one value in its table, returns an error that states where a list is allowed. Returns `None` otherwise.
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
    CombineSpec::deserialize(value).map_err(|error| refused(place, text, &error))
}

/// Returns the values of a TOML list, or an empty list for any other value.
fn list_of(place: &str, text: &str, value: &Spanned<DeValue>) -> Result<Vec<toml::Value>> {
    let DeValue::Array(values) = value.get_ref() else {
        return Ok(Vec::new());
    };
    let values = values.iter().map(|value| {
        let value = toml::de::ValueDeserializer::from(value.clone());
        toml::Value::deserialize(value).map_err(|error| refused(place, text, &error))
    });
    values.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inputs::params::{keys_of, params};
    use crate::inputs::range::Range::Any;

    params! {
        /// Study.
        pub struct Study {
            /// Seed.
            seed: u64;
            /// Swept key.
            ratio: Vec<f64> = Vec::new() => Any, Choice, Table;
            /// Swept key with one value.
            zone_mm: f64 = 0.0 => Any, Choice, Table;
            /// Table.
            skin: Skin;
            /// Key that is no axis.
            report: Option<String> => Any, Note, Never;
        }
    }

    params! {
        /// Skin.
        pub struct Skin {
            /// Key without default.
            stroke_mm: f64;
            /// Key with default.
            words: String = String::new();
        }
    }

    const TEXT: &str = "[axes]\n\"skin.stroke_mm\" = [5.0, 1]\nseed = [3, 1]\nratio = [1.0, 4.0]\n[skin]\nwords = \"a\"\n";

    fn said(text: &str) -> String {
        let read = read::<Study>("s.toml", text, keys_of::<Study>());
        let made = read.and_then(|(study, axes)| axes.variants("s.toml", &study));
        let error = made.unwrap_err();
        assert_eq!(error.exit_code(), 2);
        error.to_string()
    }

    #[test]
    fn every_combination_is_a_study_and_the_first_axis_changes_slowest() {
        let (study, axes) = read::<Study>("s.toml", TEXT, keys_of::<Study>()).unwrap();
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
        let (study, axes) = read::<Study>("s.toml", TEXT, keys_of::<Study>()).unwrap();
        let text = to_toml(&study, &axes);
        let (again, same) = read::<Study>("s.toml", &text, keys_of::<Study>()).unwrap();
        let keys = |axes: &StudyAxes| -> Vec<(String, Vec<toml::Value>)> {
            let axes = axes.axes.iter();
            axes.map(|axis| (axis.key.clone(), axis.values.clone()))
                .collect()
        };
        assert_eq!((again, keys(&same)), (study, keys(&axes)), "{text}");
    }

    #[test]
    fn a_list_in_a_table_is_an_axis_that_changes_fastest() {
        let read = |text: &str| read::<Study>("s.toml", text, keys_of::<Study>()).unwrap();
        let pairs = |text: &str| -> Vec<(f64, f64)> {
            let (study, axes) = read(text);
            let variants = axes.variants("s.toml", &study).unwrap();
            assert!(axes.n_combinations() >= variants.len() as f64);
            let variants = variants.iter();
            variants
                .map(|(_, study)| (study.skin.stroke_mm, study.zone_mm))
                .collect()
        };
        let in_table = "zone_mm = [0.0, 2.0]\nseed = 1\n[axes]\n\"skin.stroke_mm\" = [5.0, 1.0]";
        let in_axes = "seed = 1\n[axes]\nzone_mm = [0.0, 2.0]\n\"skin.stroke_mm\" = [5.0, 1.0]";
        let all = [(5.0, 0.0), (5.0, 2.0), (1.0, 0.0), (1.0, 2.0)];
        for text in [in_table, in_axes] {
            assert_eq!(pairs(text), all);
            let (study, axes) = read(text);
            let written = to_toml(&study, &axes);
            assert!(written.contains("zone_mm = [0.0, 2.0]\n"), "{written}");
            assert_eq!(pairs(&written), all);
        }
        let alone = in_table.replace("[axes]", "[axes]\ncombine = \"one_at_a_time\"");
        let alone = alone + "\n[skin]\nstroke_mm = 5.0";
        assert_eq!(pairs(&alone), all);
        for (zones, wanted) in [
            (
                "[0.0, 0.0]",
                "s.toml:1, key zone_mm: 0.0 twice; each value once",
            ),
            ("[]", "s.toml:1, key zone_mm: an empty list"),
            (
                "[0.0, \"a\"]",
                "s.toml:1, key zone_mm: zone_mm = \"a\"; invalid type",
            ),
        ] {
            let said = said(&in_table.replace("[0.0, 2.0]", zones));
            assert!(said.contains(wanted), "{said}\nis not\n{wanted}");
        }
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
}
