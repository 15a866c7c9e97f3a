//! Conditions that a query for advice fixes, such as `noise=0.05`.

use crate::error::{Error, Result};
use crate::table::{Role, Table, Value, column_name};

/// Returns the given rows that satisfy a condition of the form `noise=0.05`.
pub(super) fn rows_with(table: &Table, rows: Vec<usize>, text: &str) -> Result<Vec<usize>> {
    let refuse = || Error::input("--given", text, "a condition and its value: noise=0.05");
    let (key, value) = text.split_once('=').ok_or_else(refuse)?;
    let (key, value) = (column_name(key.trim()), value.trim());
    if key.is_empty() || value.is_empty() {
        return Err(refuse());
    }
    let place = format!("--given {key}");
    match table.column(key).map(|(column, _)| column.role) {
        Some(Role::Condition) => {}
        Some(Role::Choice) => {
            let allowed = "a condition of the world; choices are what is advised";
            return Err(Error::input(place, "is a choice", allowed));
        }
        _ => {
            let allowed = match table.of_role(Role::Condition)[..] {
                [] => "no such option: the study was made in one condition".to_owned(),
                ref known => format!("one of {}", known.join(", ")),
            };
            let given = "is no condition of this study";
            return Err(Error::input(place, given, allowed));
        }
    }
    let data = table.column(key).map(|(_, data)| data);
    let value_of = |row: usize| data.and_then(|data| data.value(row));
    let mut known = table.one_of(key, rows.iter().copied());
    if rows.iter().any(|&row| value_of(row).is_none()) {
        known += ", none";
    }
    let with = |is_wanted: &dyn Fn(Option<Value>) -> bool| -> Vec<usize> {
        let rows = rows.iter().copied();
        rows.filter(|&row| is_wanted(value_of(row))).collect()
    };
    let unit = table.column(key).map_or("", |(column, _)| &column.unit);
    let wanted = given_value(value, unit).ok_or_else(|| {
        let allowed = format!("a number, in the unit of the column: {unit}");
        Error::input(&place, value, allowed)
    })?;
    // An exact match has priority over a match within the tolerance.
    let mut found = with(&|known| known.as_ref() == Some(&wanted));
    if found.is_empty() {
        found = with(&|known| known.is_some_and(|known| known.agrees(&wanted)));
    }
    if found.is_empty() && value == "none" {
        found = with(&|known| known.is_none());
    }
    match found.is_empty() {
        true => Err(Error::input(place, value, known)),
        false => Ok(found),
    }
}

/// Parses the value of a condition: a text, or a number with an optional unit (`0.5 mm`, `5 %`). Returns `None` if the unit differs from the column's unit.
fn given_value(text: &str, unit: &str) -> Option<Value> {
    if let Ok(number) = text.parse() {
        return Some(Value::Number(number));
    }
    let ends = |letter: char| letter.is_alphabetic() || matches!(letter, '%' | '°');
    let start = text.trim_end_matches(ends).trim_end();
    let Ok(number) = start.parse::<f64>() else {
        return Some(Value::Word(text.to_owned()));
    };
    match (text[start.len()..].trim(), unit) {
        ("%", "%") => Some(Value::Number(0.01 * number)),
        (given, unit) => (given == unit).then_some(Value::Number(number)),
    }
}
