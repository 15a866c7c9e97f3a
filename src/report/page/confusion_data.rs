//! Confusion matrices as a page holds them: of the cells that matter most, and of others as long as they do not make it heavy.

use crate::report::answer::Answer;
use crate::study::table::{Confusion, Tables};
use serde::Serialize;
use std::collections::HashMap;

/// Counts in a page, at most (but for those of the first cell): each takes about eight letters.
const MOST_COUNTS: usize = 40_000;

/// What was taken for what.
#[derive(Serialize)]
pub(super) struct ConfusionData {
    names: Vec<String>,
    cells: Vec<CellConfusion>,
}

#[derive(Serialize)]
struct CellConfusion {
    /// Place of the cell in the summary.
    cell: usize,
    /// Why it comes first; empty for the others.
    why: &'static str,
    /// For each count that is not zero: touched, taken for, count.
    entries: Vec<usize>,
}

/// The best cell first, then the one with the fewest measurements that is as good, then the others in their order; none if the best
/// has no counts.
pub(super) fn confusion_data(
    tables: &Tables,
    answer: &Answer,
    names: Vec<&str>,
) -> Option<ConfusionData> {
    let number: HashMap<&str, usize> = names.iter().enumerate().map(|(i, n)| (*n, i)).collect();
    let by_cell = tables.confusion.chunk_by(|a, b| a.cell == b.cell);
    let by_cell: HashMap<usize, &[Confusion]> = by_cell.map(|rows| (rows[0].cell, rows)).collect();
    let first = [
        (&answer.best.0, "best"),
        (
            &answer.finding(&answer.best.0).frugal.0,
            "fewest measurements",
        ),
    ];
    by_cell.get(&first[0].0.cell)?;
    let others = tables.summary.iter().map(|(cell, _)| (cell, ""));
    let mut found: Vec<CellConfusion> = Vec::new();
    let mut n_counts = 0;
    let place: HashMap<usize, usize> = tables
        .summary
        .iter()
        .enumerate()
        .map(|(place, (cell, _))| (cell.cell, place))
        .collect();
    for (cell, why) in first.into_iter().chain(others) {
        let (Some(rows), Some(&cell)) = (by_cell.get(&cell.cell), place.get(&cell.cell)) else {
            continue;
        };
        if found.iter().any(|known| known.cell == cell) {
            continue;
        }
        n_counts += rows.len();
        if n_counts > MOST_COUNTS && !found.is_empty() {
            break;
        }
        let entries = rows.iter().flat_map(|row| {
            let name = |text: &String| number[text.as_str()];
            [name(&row.object), name(&row.predicted), row.count]
        });
        let entries = entries.collect();
        found.push(CellConfusion { cell, why, entries });
    }
    Some(ConfusionData {
        names: names.into_iter().map(str::to_owned).collect(),
        cells: found,
    })
}
