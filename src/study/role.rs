//! What each setting of a cell is to whoever chooses one: a choice of the designer, or a condition that the world sets.

use super::table::Cell;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::fmt::Write;
use toml::{Table, Value};

/// What a setting is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// A designer decides it. Advice and every "best" choose among these, within a condition.
    Choice,
    /// The world sets it: noise, sensor errors, another skin, wrong labels. It is given, never advised.
    Condition,
    /// It says how to read the others.
    Note,
}

/// The role of every column of [`Cell`]: a cell with a column that has none does not compile.
macro_rules! roles {
    ($($column:ident: $role:ident,)*) => {
        const ROLES: &[(&str, Role)] = &[$((stringify!($column), Role::$role)),*];
        const _: fn(&Cell) = |Cell { $($column: _),* }| ();

        /// The conditions of a cell as a text: equal texts, equal conditions.
        fn condition_key(cell: &Cell) -> String {
            let mut key = String::new();
            $(if Role::$role == Role::Condition {
                let _ = write!(key, "{:?};", cell.$column);
            })*
            key
        }
    };
}

roles! {
    cell: Note,
    pitch_mm: Choice,
    nx: Choice,
    ny: Choice,
    size_mm: Choice,
    noise_std: Condition,
    noise_unit: Note,
    smoothing_mm: Choice,
    hysteresis_full_scale: Condition,
    crosstalk: Condition,
    gain_std: Condition,
    drift_std_full_scale: Condition,
    dead_fraction: Condition,
    stuck_fraction: Condition,
    scan_time_ms: Condition,
    adc_bits: Condition,
    tested_on: Condition,
    ensemble: Choice,
    measurements: Choice,
    ratio: Choice,
    frames: Choice,
    over_time: Choice,
    features: Choice,
    classifier: Choice,
    c: Choice,
    train_touches: Choice,
    mislabelled_fraction: Condition,
    class_imbalance: Condition,
    fused_touches: Choice,
}

/// The role of a column of [`Cell`]; none for a name that is no column.
pub fn role_of(column: &str) -> Option<Role> {
    let known = ROLES.iter().find(|(name, _)| *name == column);
    known.map(|(_, role)| *role)
}

impl Cell {
    /// The cell by its columns but for its number, which says nothing about it; what is absent is left out.
    pub fn columns(&self) -> Table {
        let mut row = Table::try_from(self).expect("every field of a cell has a TOML form");
        row.remove("cell");
        row
    }

    /// Its columns that are conditions.
    pub fn conditions(&self) -> Table {
        let of_role = |(column, _): &(String, Value)| role_of(column) == Some(Role::Condition);
        self.columns().into_iter().filter(of_role).collect()
    }
}

/// For each cell the number of its condition, in the order in which cells first have them: equal numbers, equal conditions.
pub fn condition_numbers<'a>(cells: impl IntoIterator<Item = &'a Cell>) -> Vec<usize> {
    let mut known: HashMap<String, usize> = HashMap::new();
    let number = |cell: &Cell| {
        let next = known.len();
        *known.entry(condition_key(cell)).or_insert(next)
    };
    cells.into_iter().map(number).collect()
}

/// The place of the most accurate of some accuracies, of equals the first; none of none.
pub fn most_accurate(accuracies: impl IntoIterator<Item = (usize, f64)>) -> Option<usize> {
    let better = |best: (usize, f64), other: (usize, f64)| match other.1 > best.1 {
        true => other,
        false => best,
    };
    let best = accuracies.into_iter().reduce(better);
    best.map(|(place, _)| place)
}

/// A column as people may write it: `noise` stands for `noise_std`.
pub fn column_name(key: &str) -> &str {
    match key {
        "noise" => "noise_std",
        other => other,
    }
}

/// Numbers this close, relative to the larger, are the same setting: a ratio of 100 on 4,096 taxels is 41 measurements, which
/// are 99.90:1. Larger, and neighbouring settings would be taken for each other; smaller, and that ratio would be refused.
const SAME_SETTING: f64 = 1e-3;

/// Whether two values of a column are the same setting.
pub fn agree(value: &Value, wanted: &Value) -> bool {
    match (number(value), number(wanted)) {
        (Some(a), Some(b)) => (a - b).abs() <= SAME_SETTING * a.abs().max(b.abs()),
        _ => value == wanted,
    }
}

fn number(value: &Value) -> Option<f64> {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|integer| integer as f64))
}

/// The values, each once: `one of 16, 64`.
pub fn one_of(values: impl IntoIterator<Item = String>) -> String {
    let mut seen: Vec<String> = Vec::new();
    for value in values {
        if !seen.contains(&value) {
            seen.push(value);
        }
    }
    format!("one of {}", seen.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::TestedOn;
    use crate::study::table::tests::cell;

    #[test]
    fn cells_that_differ_in_choices_alone_share_a_condition() {
        let mut cells = vec![cell(); 5];
        cells[1].measurements = 16;
        cells[2].noise_std = 0.0;
        cells[3].smoothing_mm = 4.0;
        cells[4].tested_on = Some(TestedOn::AnotherSkin);
        assert_eq!(condition_numbers(&cells), [0, 0, 1, 0, 2]);
    }
}
