//! Bounds of the numbers in a TOML file, for any key. All numbers are finite, and none is far beyond the range of its unit in robotics. Whole numbers are
//! integers that a TOML table can store.
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
pub(super) struct Bound(f64, &'static str);

impl Bound {
    /// Bound of numbers without a unit.
    pub const PLAIN: Self = Self(MAX_PLAIN, "");
}

/// Returns an error unless all numbers of the table of a TOML text are within the bounds of their units.
///
/// # Errors
/// If a number is not finite, beyond the bound of its unit, or an integer of more than 64 bits. The error names `place` (the file), the line and the key.
pub(super) fn check_numbers(place: &str, text: &str, table: &DeTable) -> Result<()> {
    each_value("", Bound::PLAIN, table, &mut |path, bound, value| {
        let Some((given, allowed)) = fault(bound, value.get_ref()) else {
            return Ok(());
        };
        let line = line_of(text, value.span().start);
        let place = format!("{place}:{line}, key {path}");
        Err(Error::input(place, given, allowed))
    })
}

/// Returns the number in a message and the allowed numbers, if a value is a number beyond its bound.
fn fault(Bound(largest, unit): Bound, value: &DeValue) -> Option<(String, String)> {
    let allowed = || {
        let shown = match largest < 1e7 {
            true => largest.to_string(),
            false => format!("{largest:e}"),
        };
        format!("at most {shown}{unit} in magnitude")
    };
    match value {
        DeValue::Float(number) => {
            let number: f64 = number.as_str().parse().ok()?;
            if !number.is_finite() {
                return Some((number.to_string(), "a finite number".to_owned()));
            }
            (number.abs() > largest).then(|| (format!("{number:e}"), allowed()))
        }
        DeValue::Integer(number) => {
            let Ok(integer) = i64::from_str_radix(number.as_str(), number.radix()) else {
                let given = format!("{number}, which is too large");
                return Some((given, "expected a number below 2⁶³".to_owned()));
            };
            // Integers without a unit are counts and seeds, whose own checks have bounds.
            let is_large = largest < MAX_PLAIN && integer.unsigned_abs() as f64 > largest;
            is_large.then(|| (integer.to_string(), allowed()))
        }
        _ => None,
    }
}

/// Calls `visit` with the path and the bound of each value of a table and its subtables, other than tables; a list precedes its entries. `path` is the path of
/// the table, and `outer` the bound of a key without a unit.
///
/// # Errors
/// Returns the first error of `visit`.
pub(super) fn each_value<E>(
    path: &str,
    outer: Bound,
    table: &DeTable,
    visit: &mut impl FnMut(&str, Bound, &Spanned<DeValue>) -> std::result::Result<(), E>,
) -> std::result::Result<(), E> {
    table.iter().try_for_each(|(name, value)| {
        let name = name.get_ref();
        let known = BOUNDS.iter().find(|(end, ..)| name.ends_with(end));
        // In `{ grid = [0, 50, 6] }` the outer key has the unit.
        let bound = known.map_or(outer, |&(_, largest, unit)| Bound(largest, unit));
        let path = match path {
            "" => name.to_string(),
            _ => format!("{path}.{name}"),
        };
        each_entry(&path, bound, value, visit)
    })
}

fn each_entry<E>(
    path: &str,
    bound: Bound,
    value: &Spanned<DeValue>,
    visit: &mut impl FnMut(&str, Bound, &Spanned<DeValue>) -> std::result::Result<(), E>,
) -> std::result::Result<(), E> {
    if let DeValue::Table(table) = value.get_ref() {
        return each_value(path, bound, table, visit);
    }
    visit(path, bound, value)?;
    let entries = value.get_ref().as_array().into_iter().flatten();
    entries.zip(1..).try_for_each(|(entry, number)| {
        let Some(table) = entry.get_ref().as_table() else {
            return each_entry(path, bound, entry, visit);
        };
        // Formats the table as the checks of single keys do: by its name, or by its number from 1.
        let path = match table.get("name").and_then(|name| name.get_ref().as_str()) {
            Some(name) => format!("{path}.{name}"),
            None => format!("{path}[{number}]"),
        };
        each_value(&path, bound, table, visit)
    })
}

#[cfg(test)]
mod tests {
    use crate::text::toml_text::TomlText;

    const TEXT: &str = "seed = 9000000000000000000\n[skin]\nstroke_mm = 5\n\n[[objects]]\nname = \"ball\"\nfree = { mass_kg = 1.0 }\n[[objects]]\nname = \"box\"\nat = { position_mm = [\n0.0, 1.0, 2.0] }\n";

    fn said(text: &str) -> String {
        let error = TomlText::parse("s.toml", text).err().unwrap();
        assert_eq!(error.exit_code(), 2);
        error.to_string()
    }

    #[test]
    fn every_number_is_finite_and_within_what_its_unit_measures() {
        assert!(TomlText::parse("s.toml", TEXT).is_ok());
        // A text of the file, what replaces it, and a part of the error.
        let changes = "= 5 | = 1e308 | s.toml:3, key skin.stroke_mm: 1e308; at most 1e7 mm
            = 5 | = 10000001 | s.toml:3, key skin.stroke_mm: 10000001; at most
            = 5 | = -inf | s.toml:3, key skin.stroke_mm: -inf; a finite number
            2.0] | nan] | s.toml:11, key objects.box.at.position_mm: NaN; a finite
            2.0] | -2e9] | s.toml:11, key objects.box.at.position_mm: -2e9; at most
            = 5 | = { grid = [1.0, 1e9, 3] } | s.toml:3, key skin.stroke_mm.grid: 1e9
            seed = 9000000000000000000 | c = 1e101 | s.toml:1, key c: 1e101; at most 1e100
            [skin] | axes = { \"skin.stroke_mm\" = [1.0, 1e8] } [skin] | key axes.skin.stroke_mm: 1e8";
        for change in changes.lines() {
            let [old, new, wanted] = change.trim().split(" | ").collect::<Vec<_>>()[..] else {
                panic!("{change}");
            };
            let said = said(&TEXT.replace(old, &new.replace(" [skin]", "\n[skin]")));
            assert!(said.contains(wanted), "{said}\nis not\n{wanted}");
        }
    }
}
