//! The folder of a study of breaking points, and what it prints at its end.

use super::breaking_points_charts::{break_words, draw_breaking_points};
use crate::error::Result;
use crate::report::axis::{classifier_name, short_number};
use crate::report::folder::Folder;
use crate::report::page::StudyAbout;
use crate::report::page::plain::{self, plain_page};
use crate::report::study_tables::{StudyTables, TableFiles, table_file};
use crate::report::terminal::{align_right, plain_table};
use crate::study::breaking_points::PlannedWay;
use crate::study::breaking_points::table::{BreakingPoint, BreakingPointsTables, Side};
use comfy_table::Table;
use std::path::{Path, PathBuf};

impl StudyTables for BreakingPointsTables {
    const OF_PIECES: &'static [&'static str] = &["accuracy.csv", "summary.csv"];
    const OF_ALL: &'static [&'static str] = &["breaking_points.csv"];

    fn files(&self) -> Result<TableFiles> {
        Ok(vec![
            table_file("accuracy.csv", &self.accuracy)?,
            table_file("summary.csv", &self.summary)?,
            table_file("breaking_points.csv", &self.breaking_points)?,
            table_file("timing.csv", &self.timing)?,
        ])
    }
}

/// Writes tables, charts and the page into `dir` (created if missing); returns the paths, tables first.
///
/// Everything is drawn before the first file is written, and each file is whole or not there.
pub fn write_breaking_points(
    dir: &Path,
    ways: &[PlannedWay],
    tables: &BreakingPointsTables,
    about: &StudyAbout,
) -> Result<Vec<PathBuf>> {
    let mut folder = Folder::new(dir);
    let files = tables.files()?;
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    folder.add_files(files);
    let drawn = draw_breaking_points(ways, tables);
    for (name, title, drawing) in &drawn {
        folder.add_chart(name, title, drawing)?;
    }
    let note = "Each setting alone is driven to its ends; the interval is that of the place where accuracy is half of its best.";
    let found = vec![
        plain::answer(&sentences(tables)),
        plain::table(
            "breaks",
            "Breaking points",
            note,
            &breaks_table(tables, 200),
        ),
        // The first is all others in one.
        plain::charts(&drawn[1..]),
    ];
    folder.add("report.html", plain_page(about, found, &names));
    folder.write()
}

/// How many settings break recognition, then those that do, each with the classifier that stands it longest.
fn sentences(tables: &BreakingPointsTables) -> Vec<String> {
    let rows = &tables.breaking_points;
    let mut ways: Vec<&str> = rows.iter().map(|row| row.way.as_str()).collect();
    ways.dedup();
    let breaks_all = |way: &&&str| {
        let mut of_way = rows.iter().filter(|row| row.way == **way).peekable();
        of_way.peek().is_some() && {
            let kinds: Vec<_> = of_way.clone().map(|row| row.classifier).collect();
            kinds.iter().all(|kind| {
                let mut of_kind = of_way.clone().filter(|row| row.classifier == *kind);
                of_kind.any(|row| row.is_reached)
            })
        }
    };
    let broken: Vec<&&str> = ways.iter().filter(breaks_all).collect();
    let first = format!(
        "{} of {} settings, driven to their ends, take every classifier to half of its best or below.",
        broken.len(),
        ways.len()
    );
    let sentence = |row: &BreakingPoint| {
        let place = break_words(row)?;
        let kind = classifier_name(row.classifier);
        let best = format!("{:.3} at {}", row.best, short_number(row.best_at));
        Some(format!(
            "{}, {kind}: half of its best ({best}) at {place}.",
            row.way
        ))
    };
    std::iter::once(first)
        .chain(rows.iter().filter_map(sentence))
        .collect()
}

/// A line a way, classifier and side. Lines are at most about `width` letters long.
pub fn breaking_points_summary(tables: &BreakingPointsTables, width: usize) -> String {
    format!("{}\n", breaks_table(tables, width))
}

fn breaks_table(tables: &BreakingPointsTables, width: usize) -> Table {
    let mut table = plain_table(width);
    table.set_header([
        "way",
        "classifier",
        "best",
        "at",
        "half of it at (95 % interval)",
        "at the end",
        "accuracy",
    ]);
    for row in &tables.breaking_points {
        let side = match row.side {
            Side::Smaller => "not below",
            Side::Larger => "not above",
        };
        table.add_row([
            row.way.clone(),
            classifier_name(row.classifier).to_owned(),
            format!("{:.3}", row.best),
            short_number(row.best_at),
            break_words(row).unwrap_or_else(|| side.to_owned()),
            short_number(row.end),
            format!("{:.3}", row.accuracy_at_end),
        ]);
    }
    align_right(&mut table, 2..7);
    table
}
