//! What moved between two runs, for the terminal.

use crate::report::terminal::{align, finish, ruled_table, wrap};
use crate::report::varying::{Levels, Settings, unbroken_parts};
use crate::spelling::counted;
use crate::study::table::{Cell, PStatus};
use crate::study::{RunComparison, RunDifference};
use comfy_table::Table;

/// Cells that are listed, at most.
const MOST_LISTED: usize = 30;

/// Sentences and a table of lines at most `width` letters long: the cells that moved most surely first.
pub fn differences_text(comparison: &RunComparison, width: usize) -> String {
    let cells: Vec<&Cell> = comparison.both.iter().map(|(cell, _)| cell).collect();
    let settings = Settings::of(&cells);
    let fixed: Vec<String> = settings.fixed.iter().map(Levels::sentence).collect();
    let mut sentences = vec![format!("All cells: {}", unbroken_parts(&fixed))];
    sentences.extend(verdict(comparison));
    let mut text = String::new();
    for sentence in sentences {
        text += &wrap(&sentence, width).join("\n");
        text.push('\n');
    }
    let left_out = match comparison.both.len().saturating_sub(MOST_LISTED) {
        0 => String::new(),
        n => {
            format!("{n} cells that moved less surely are left out here; --out FILE.csv has all\n")
        }
    };
    let table = differences_table(comparison, &settings, width, MOST_LISTED);
    text + "\n" + &finish(&table) + &left_out
}

/// What moved, in sentences.
pub(super) fn verdict(comparison: &RunComparison) -> Vec<String> {
    let rows = || comparison.both.iter().map(|(_, row)| row);
    let surely = |better: bool| {
        let moved = rows().filter(|row| row.is_significant() && (row.difference > 0.0) == better);
        moved.count()
    };
    let n_same = rows().filter(|row| row.difference == 0.0).count();
    let n_tested = rows().filter(|row| row.p_holm.is_some()).count();
    let n_both = comparison.both.len();
    let mut sentences = vec![format!(
        "{n_both} cells are in both runs, {} in the first alone, {} in the second alone; {n_same} have the same accuracy.",
        comparison.n_first_only, comparison.n_second_only
    )];
    sentences.push(match n_tested {
        0 => {
            let row = rows().find(|row| row.p_status == PStatus::TooFewTrials);
            too_few_words(row.and_then(|row| Some((row.n_trials, row.n_trials_needed?))))
        }
        _ => format!(
            "Better in the second than chance explains: {}; worse: {} (t-test paired over trials, corrected for their overlap, \
             p < 0.05 after Holm's correction for {n_tested} cells).",
            surely(true),
            surely(false)
        ),
    });
    sentences
}

/// That there are no p-values, for so many trials where so many are needed.
pub(super) fn too_few_words(trials: Option<(usize, usize)>) -> String {
    match trials {
        Some((n_trials, needed)) => format!(
            "No p-values: {} a cell are too few to tell a difference from chance; {needed} are needed.",
            counted(n_trials, "trial")
        ),
        None => {
            "No p-values: more rows are tested than trained on, or trials are missing.".to_owned()
        }
    }
}

/// The cells that moved most surely, at most so many, in lines of so many letters.
pub(super) fn differences_table(
    comparison: &RunComparison,
    settings: &Settings,
    width: usize,
    most: usize,
) -> Table {
    let axes = settings.shown();
    let mut rows: Vec<&(Cell, RunDifference)> = comparison.both.iter().collect();
    rows.sort_by(|(_, a), (_, b)| {
        let p = |row: &RunDifference| row.p_holm.unwrap_or(1.0);
        let by_size = b.difference.abs().total_cmp(&a.difference.abs());
        p(a).total_cmp(&p(b)).then(by_size)
    });
    let mut table = ruled_table(width);
    let names = axes.iter().map(|levels| levels.axis.name().to_owned());
    let heads = ["first", "second", "difference [95 %]", "p (Holm)"].map(str::to_owned);
    table.set_header(names.chain(heads));
    for (cell, row) in rows.iter().take(most) {
        let labels = axes.iter().map(|levels| levels.axis.value(cell).label);
        table.add_row(labels.chain(numbers(row)));
    }
    align(&mut table, &axes, 4);
    table
}

fn numbers(row: &RunDifference) -> [String; 4] {
    let interval = match (row.difference_low, row.difference_high) {
        (Some(low), Some(high)) => format!(" [{low:+.3}, {high:+.3}]"),
        _ => String::new(),
    };
    [
        format!("{:.3}", row.first_accuracy),
        format!("{:.3}", row.second_accuracy),
        format!("{:+.3}{interval}", row.difference),
        match (row.p_holm, row.p_status) {
            (Some(p), _) => format!("{p:.3}"),
            (None, PStatus::TooFewTrials) => "too few trials".to_owned(),
            (None, _) => "-".to_owned(),
        },
    ]
}
