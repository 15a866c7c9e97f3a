//! What moved between two runs: sentences, a table, and a page.

use crate::error::Result;
use crate::report::page::StudyAbout;
use crate::report::recognition::say;
use crate::report::study_folder::{Found, page_of};
use crate::report::terminal::{paragraph, table_text};
use crate::spelling::counted;
use crate::study::table::{Cell, PStatus};
use crate::study::{RunComparison, RunDifference};
use crate::table::{Along, At, ChartSpec, Column, Columns, Data, Mark, Role, Rule, Scale, Table};

/// Sentences and a table of lines at most `width` letters long: the cells that moved most surely first.
///
/// # Errors
/// Rows that have no form in a table.
pub fn differences_text(comparison: &RunComparison, width: usize) -> Result<String> {
    let mut text: String = verdict(comparison)
        .iter()
        .map(|sentence| paragraph(sentence, width))
        .collect();
    text.push('\n');
    text += &table_text(&table(comparison)?, width);
    Ok(text)
}

/// The page of two runs by their names, and the program that made it.
///
/// # Errors
/// As [`differences_text`]; a chart that cannot be drawn.
pub fn differences_page(
    comparison: &RunComparison,
    (first, second): (&str, &str),
    program: &str,
) -> Result<String> {
    let table = table(comparison)?.noted(format!(
        "First: {first}; second: {second}. The cells that moved most surely come first."
    ));
    let about = StudyAbout {
        name: format!("{first} and {second}"),
        program: program.to_owned(),
        wall_s: f64::NAN,
        ..StudyAbout::default()
    };
    let chart = ChartSpec {
        name: "differences".to_owned(),
        title: "Accuracy of each cell in both runs".to_owned(),
        note: format!("Up: {second}. Across: {first}."),
        table: table.file,
        x: "first_accuracy".to_owned(),
        y: "second_accuracy".to_owned(),
        lines: vec!["moved".to_owned()],
        mark: Mark::Points,
        rules: vec![Rule {
            along: Along::Y,
            at: At::Column("first_accuracy".to_owned()),
            words: "no difference".to_owned(),
        }],
        ..ChartSpec::default()
    };
    page_of(
        &about,
        &Found {
            tables: &[table],
            charts: &[chart],
            pictures: &[],
            answers: &verdict(comparison),
        },
    )
}

/// All cells, those first that moved most surely.
fn table(comparison: &RunComparison) -> Result<Table> {
    let mut rows: Vec<(Cell, RunDifference)> = comparison.both.clone();
    rows.sort_by(|(_, a), (_, b)| {
        let p = |row: &RunDifference| row.p_holm.unwrap_or(1.0);
        let by_size = b.difference.abs().total_cmp(&a.difference.abs());
        p(a).total_cmp(&p(b)).then(by_size)
    });
    let moved = rows.iter().map(|(_, row)| {
        let words = match row.is_significant() {
            true => "more than chance explains",
            false => "chance explains it",
        };
        words.to_owned()
    });
    let column = Column::new("moved", Role::Note, "difference", "", Scale::Words);
    let first = rows.first().map(|(cell, _)| cell.variant.values.iter());
    let axes = first.into_iter().flatten().map(|axis| axis.column.clone());
    let columns = Cell::columns()
        .into_iter()
        .chain(axes)
        .chain(RunDifference::columns());
    let mut table = Table::of_columns(
        ("differences.csv", "Cells of both runs"),
        columns.collect(),
        &rows,
    )?;
    say(&mut table);
    Ok(table.with(
        ("differences.csv", "Cells of both runs"),
        vec![(column, Data::of_words(moved))],
    ))
}

/// What moved, in sentences.
fn verdict(comparison: &RunComparison) -> Vec<String> {
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
fn too_few_words(trials: Option<(usize, usize)>) -> String {
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
