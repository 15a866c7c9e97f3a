//! Grouping of configurations by the condition of the world; the best configuration is selected within each condition.

use crate::error::Result;
use crate::studies::recognition::rows::cell::Cell;
use crate::table::{Columns, File, Role, Table};

/// Returns a table of the settings of configurations, without scores.
///
/// # Errors
/// If a configuration cannot be written as a row of a table.
pub fn settings_of(cells: &[&Cell]) -> Result<Table> {
    let axes = cells.first().map(|cell| cell.variant.values.iter());
    let axes = axes.into_iter().flatten();
    let axes = axes.map(|axis| axis.column.clone().optional());
    let columns = Cell::columns().into_iter().chain(axes).collect();
    File::<Cell>::new("cells.csv", "Cells", "").of_columns(columns, cells)
}

/// Returns the indices of the configurations of each condition, in the order of first occurrence.
///
/// # Errors
/// If [`settings_of`] fails.
pub fn by_condition<'a>(cells: impl IntoIterator<Item = &'a Cell>) -> Result<Vec<Vec<usize>>> {
    let cells = settings_of(&cells.into_iter().collect::<Vec<_>>())?;
    Ok(cells.groups(&cells.of_role(Role::Condition), 0..cells.n_rows))
}

/// Returns the index of the largest accuracy, in a tie the first; `None` if there are no accuracies.
pub fn most_accurate(accuracies: impl IntoIterator<Item = (usize, f64)>) -> Option<usize> {
    let better = |best: (usize, f64), other: (usize, f64)| match other.1 > best.1 {
        true => other,
        false => best,
    };
    let best = accuracies.into_iter().reduce(better);
    best.map(|(place, _)| place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inputs::sensor_errors::TestedOn;
    use crate::studies::recognition::rows::cell::tests::cell;

    #[test]
    fn cells_that_differ_in_choices_alone_share_a_condition() {
        let mut cells = vec![cell(); 6];
        cells[1].measurements = 16;
        cells[2].noise_std = 0.0;
        cells[3].smoothing_mm = 4.0;
        for cell in &mut cells {
            cell.tested_on = Some(TestedOn::SameSkin);
        }
        cells[4].tested_on = Some(TestedOn::AnotherSkin);
        let alike = by_condition(&cells).unwrap();
        assert_eq!(alike, [vec![0, 1, 3, 5], vec![2], vec![4]]);
    }
}
