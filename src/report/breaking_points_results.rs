//! The folder of a study of breaking points, and what it prints at its end.

use super::breaking_points_charts::{break_words, draw_breaking_points};
use crate::error::Result;
use crate::report::axis::{classifier_name, short_number};
use crate::report::folder::Folder;
use crate::report::study_tables::{StudyTables, TableFiles, table_file};
use crate::report::terminal::{align_right, plain_table};
use crate::study::breaking_points::PlannedWay;
use crate::study::breaking_points::table::{BreakingPointsTables, Side};
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

/// Writes tables and charts into `dir` (created if missing); returns the paths, tables first.
///
/// Everything is drawn before the first file is written, and each file is whole or not there.
pub fn write_breaking_points(
    dir: &Path,
    ways: &[PlannedWay],
    tables: &BreakingPointsTables,
) -> Result<Vec<PathBuf>> {
    let mut folder = Folder::new(dir);
    folder.add_files(tables.files()?);
    for (name, title, drawing) in draw_breaking_points(ways, tables) {
        folder.add_chart(&name, &title, &drawing)?;
    }
    folder.write()
}

/// A line a way, classifier and side. Lines are at most about `width` letters long.
pub fn breaking_points_summary(tables: &BreakingPointsTables, width: usize) -> String {
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
    format!("{table}\n")
}
