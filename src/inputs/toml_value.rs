//! Access to the values of a TOML table by key path.

use serde::Serialize;

/// Returns the TOML value at a dotted path of keys; `None` if the path does not exist.
pub(crate) fn value_at<'t>(table: &'t toml::Table, path: &str) -> Option<&'t toml::Value> {
    let mut names = path.split('.');
    let first = table.get(names.next()?)?;
    names.try_fold(first, |value, name| value.get(name))
}

/// Returns the keys of a study or of one of its tables.
///
/// # Panics
/// If a field has no TOML form.
pub(crate) fn table_of(keys: &impl Serialize) -> toml::Table {
    toml::Table::try_from(keys).expect("every field of a study has a TOML form")
}

/// Returns a TOML integer or float as a number; `None` for another value.
pub(crate) fn number(value: &toml::Value) -> Option<f64> {
    let integer = || value.as_integer().map(|integer| integer as f64);
    value.as_float().or_else(integer)
}

/// Returns a number as a TOML value; whole numbers have no decimal point.
pub(crate) fn number_value(number: f64, is_whole: bool) -> toml::Value {
    match is_whole {
        true => (number as i64).into(),
        false => number.into(),
    }
}

/// Returns whether a value, or each value of a list, equals `expected`. Integers and floats are compared as numbers.
pub(crate) fn has_only(value: &toml::Value, expected: &toml::Value) -> bool {
    let is_equal = |value: &toml::Value| match (number(value), number(expected)) {
        (Some(value), Some(expected)) => value == expected,
        _ => value == expected,
    };
    is_equal(value)
        || value
            .as_array()
            .is_some_and(|values| values.iter().all(is_equal))
}

/// Returns whether a dotted key path equals `name` or is below `name`.
pub(crate) fn is_at(key: &str, name: &str) -> bool {
    let rest = key.strip_prefix(name);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}
