//! Bounds of the numbers in a TOML file, for any key. All numbers are finite, and none is far beyond the range of its unit in robotics.
//!
//! The end of a key names its unit (`stroke_mm`). A number without a unit is bounded by `MAX_PLAIN`. The check runs when a file is read,
//! before its keys are known; checks of single keys are narrower.

use super::toml_lines::line_of;
use crate::error::{Error, Result};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Suffixes of keys with the largest allowed magnitude and the unit; longer suffixes come first. The bounds are three or more powers of ten above the largest
/// values in use. If larger, squares overflow, or steps and cells become too many; if smaller, valid machines are rejected.
const BOUNDS: [(&str, f64, &str); 19] = [
    ("_n_s_per_m", 1e9, " N·s/m"),
    ("_mm_per_s", 1e7, " mm/s"),
    ("_deg_per_s", 1e7, "°/s"),
    ("_m_per_s2", 1e6, " m/s²"),
    ("_n_per_m", 1e12, " N/m"),
    ("_deg", 1e6, "°"),
    ("_rad", 1e5, " rad"),
    ("_gib", 1e9, " GiB"),
    ("_mm", 1e7, " mm"),
    ("_ms", 1e12, " ms"),
    ("_us", 1e12, " µs"),
    ("_hz", 1e12, " Hz"),
    ("_kg", 1e9, " kg"),
    ("_pa", 1e12, " Pa"),
    ("_n", 1e9, " N"),
    ("_m", 1e4, " m"),
    ("_s", 1e12, " s"),
    ("_g", 1e12, " g"),
    ("_full_scale", 1e12, ""),
];

/// Largest magnitude of a number without a unit; its square, and sums of millions of squares, are finite in f64.
const MAX_PLAIN: f64 = 1e100;

/// Bound of the values of a key: the largest allowed magnitude, and its unit.
#[derive(Clone, Copy)]
struct Bound(f64, &'static str);

/// Returns an error unless all numbers of a TOML text are within the bounds of their units.
///
/// # Errors
/// If a number is not finite or beyond the bound of its unit. The error names `place` (the file), the line and the key.
pub fn check_bounds(place: &str, text: &str) -> Result<()> {
    let Ok(table) = DeTable::parse(text) else {
        // The TOML reader reports the syntax error later.
        return Ok(());
    };
    let checked = Text { place, text };
    checked.table("", Bound(MAX_PLAIN, ""), table.get_ref())
}

/// TOML text, with its name in error messages.
struct Text<'a> {
    place: &'a str,
    text: &'a str,
}

impl Text<'_> {
    fn table(&self, path: &str, outer: Bound, table: &DeTable) -> Result<()> {
        for (name, value) in table {
            let name = name.get_ref();
            let known = BOUNDS.iter().find(|(end, ..)| name.ends_with(end));
            // In `{ grid = [0, 50, 6] }` the outer key has the unit.
            let bound = known.map_or(outer, |&(_, largest, unit)| Bound(largest, unit));
            let path = match path {
                "" => name.to_string(),
                _ => format!("{path}.{name}"),
            };
            self.value(&path, bound, value)?;
        }
        Ok(())
    }

    fn value(&self, path: &str, bound: Bound, value: &Spanned<DeValue>) -> Result<()> {
        let Bound(largest, unit) = bound;
        let refuse = |given: &str, allowed: String| {
            let line = line_of(self.text, value.span().start);
            let place = format!("{}:{line}, key {path}", self.place);
            Err(Error::input(place, given, allowed))
        };
        match value.get_ref() {
            DeValue::Table(table) => self.table(path, bound, table),
            DeValue::Array(values) => {
                let mut values = values.iter().enumerate();
                values.try_for_each(|(number, value)| match value.get_ref().as_table() {
                    // Formats the table as the checks of single keys do: by its name, or by its number from 1.
                    Some(table) => {
                        let name = table.get("name").and_then(|name| name.get_ref().as_str());
                        let path = match name {
                            Some(name) => format!("{path}.{name}"),
                            None => format!("{path}[{}]", number + 1),
                        };
                        self.table(&path, bound, table)
                    }
                    None => self.value(path, bound, value),
                })
            }
            DeValue::Float(number) => match number.as_str().parse::<f64>() {
                Ok(number) if !number.is_finite() => {
                    refuse(&number.to_string(), "a finite number".to_owned())
                }
                Ok(number) if number.abs() > largest => {
                    let allowed = format!("at most {}{unit} in magnitude", shown(largest));
                    refuse(&format!("{number:e}"), allowed)
                }
                _ => Ok(()),
            },
            // Integers without a unit are counts and seeds, whose own checks have bounds.
            DeValue::Integer(number) if largest < MAX_PLAIN => {
                let number = i64::from_str_radix(number.as_str(), number.radix());
                match number {
                    Ok(number) if number.unsigned_abs() as f64 > largest => {
                        let allowed = format!("at most {}{unit} in magnitude", shown(largest));
                        refuse(&number.to_string(), allowed)
                    }
                    _ => Ok(()),
                }
            }
            _ => Ok(()),
        }
    }
}

fn shown(number: f64) -> String {
    match number < 1e7 {
        true => number.to_string(),
        false => format!("{number:e}"),
    }
}

/// Adds the line of the key, as in `file:12, key skin.stroke_mm`, to an error that contains a key of this text without a line.
pub fn with_line(place: &str, text: &str, error: Error) -> Error {
    let Error::Input {
        place: named,
        given,
        allowed,
    } = &error
    else {
        return error;
    };
    if named.starts_with("key ") {
        let whole = Error::input(format!("{place}, {named}"), given, allowed);
        return with_line(place, text, whole);
    }
    let key = named.strip_prefix(place).and_then(|rest| {
        let rest = rest.strip_prefix(", key ")?;
        rest.split([',', ':', ' ']).next()
    });
    let Some(line) = key.and_then(|key| line_of_key(text, key)) else {
        return error;
    };
    let rest = &named[place.len()..];
    Error::input(format!("{place}:{line}{rest}"), given, allowed)
}

/// Returns the line number of a key, or of the innermost existing table on its path. Returns `None` if the first part of the path does not exist. A part of
/// a path is a name, a name with a number from 1 (`parts[2]`), or the name of a table in an array (`objects.ball`).
fn line_of_key(text: &str, path: &str) -> Option<usize> {
    let table = DeTable::parse(text).ok()?;
    let mut inside = table.get_ref();
    let mut parts = path.split('.').peekable();
    let mut start = None;
    while let Some(part) = parts.next() {
        let (name, number) = match part.split_once('[') {
            Some((name, number)) => (name, number.trim_end_matches(']').parse::<usize>().ok()),
            None => (part, None),
        };
        let Some((key, value)) = inside.get_key_value(name) else {
            break;
        };
        start = Some(key.span().start);
        inside = match value.get_ref() {
            DeValue::Table(table) => table,
            DeValue::Array(tables) => {
                let has_name = |value: &&Spanned<DeValue>, name: &str| {
                    let named = value
                        .get_ref()
                        .get("name")
                        .and_then(|v| v.get_ref().as_str());
                    named == Some(name)
                };
                let found = match (number, parts.peek()) {
                    (Some(number), _) => tables.get(number.checked_sub(1)?),
                    (None, Some(name)) => tables.iter().find(|value| has_name(value, name)),
                    (None, None) => None,
                };
                let Some(found) = found else { break };
                if number.is_none() {
                    parts.next();
                }
                start = Some(found.span().start);
                let Some(table) = found.get_ref().as_table() else {
                    break;
                };
                table
            }
            _ => break,
        };
    }
    start.map(|start| line_of(text, start))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "seed = 9000000000000000000\n[skin]\nstroke_mm = 5\n\n[[objects]]\nname = \"ball\"\nfree = { mass_kg = 1.0 }\n[[objects]]\nname = \"box\"\nat = { position_mm = [\n0.0, 1.0, 2.0] }\n";

    fn said(text: &str) -> String {
        let error = check_bounds("s.toml", text).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        error.to_string()
    }

    #[test]
    fn every_number_is_finite_and_within_what_its_unit_measures() {
        assert!(check_bounds("s.toml", TEXT).is_ok());
        for (old, new, wanted) in [
            (
                "= 5",
                "= 1e308",
                "s.toml:3, key skin.stroke_mm: 1e308; at most 1e7 mm",
            ),
            (
                "= 5",
                "= 10000001",
                "s.toml:3, key skin.stroke_mm: 10000001; at most",
            ),
            (
                "= 5",
                "= -inf",
                "s.toml:3, key skin.stroke_mm: -inf; a finite number",
            ),
            (
                "2.0]",
                "nan]",
                "s.toml:11, key objects.box.at.position_mm: NaN; a finite",
            ),
            (
                "2.0]",
                "-2e9]",
                "s.toml:11, key objects.box.at.position_mm: -2e9; at most",
            ),
            (
                "= 5",
                "= { grid = [1.0, 1e9, 3] }",
                "s.toml:3, key skin.stroke_mm.grid: 1e9",
            ),
            (
                "seed = 9000000000000000000",
                "c = 1e101",
                "s.toml:1, key c: 1e101; at most 1e100",
            ),
            (
                "[skin]",
                "[axes]\n\"skin.stroke_mm\" = [1.0, 1e8]\n[skin]",
                "key axes.skin.stroke_mm: 1e8",
            ),
        ] {
            let said = said(&TEXT.replace(old, new));
            assert!(said.contains(wanted), "{said}\nis not\n{wanted}");
        }
    }

    #[test]
    fn an_error_about_a_key_gets_the_line_of_the_key() {
        for (key, wanted) in [
            ("skin.stroke_mm", "s.toml:3, key skin.stroke_mm"),
            ("skin.pitch_mm", "s.toml:2, key skin.pitch_mm"),
            ("objects.box.at.position_mm", "s.toml:10, key objects.box"),
            ("objects[1].free.mass_kg", "s.toml:7, key objects[1]"),
            ("touches", "s.toml, key touches"),
        ] {
            let error = Error::input(format!("s.toml, key {key}"), 1, 2);
            let said = with_line("s.toml", TEXT, error).to_string();
            assert!(said.starts_with(wanted), "{said}\nis not\n{wanted}");
        }
    }
}
