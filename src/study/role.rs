//! What each setting of a cell is to whoever chooses one: a choice of the designer, or a condition that the world sets.

use super::table::Cell;
use crate::table::{Columns, Role};
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::LazyLock;
use toml::{Table, Value};

/// The role of a column of [`Cell`]; none for a name that is no column.
pub fn role_of(column: &str) -> Option<Role> {
    static ROLES: LazyLock<Vec<(Cow<str>, Role)>> = LazyLock::new(|| {
        let columns = Cell::columns().into_iter();
        columns.map(|column| (column.name, column.role)).collect()
    });
    let known = ROLES.iter().find(|(name, _)| *name == column);
    known.map(|(_, role)| *role)
}

impl Cell {
    /// The cell by its columns but for its number, which says nothing about it; what is absent is left out.
    pub fn settings(&self) -> Table {
        let mut row = Table::try_from(self).expect("every field of a cell has a TOML form");
        row.remove("cell");
        row
    }

    /// Its columns that are conditions.
    pub fn conditions(&self) -> Table {
        let axes = &self.variant.values;
        let role = |column: &str| {
            let own = axes.iter().find(|axis| axis.column.name == column);
            own.map_or_else(|| role_of(column), |axis| Some(axis.column.role))
        };
        let of_role = |(column, _): &(String, Value)| role(column) == Some(Role::Condition);
        self.settings().into_iter().filter(of_role).collect()
    }
}

/// For each cell the number of its condition, in the order in which cells first have them: equal numbers, equal conditions.
pub fn condition_numbers<'a>(cells: impl IntoIterator<Item = &'a Cell>) -> Vec<usize> {
    let mut known: HashMap<String, usize> = HashMap::new();
    let number = |cell: &Cell| {
        let next = known.len();
        *known.entry(cell.conditions().to_string()).or_insert(next)
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
