//! The folder of a study of breaking points, and what it prints at its end.

use super::breaking_points_charts::{break_words, draw_breaking_points, short_number_rounded};
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
use std::path::Path;

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

/// Tables, charts and the page, tables first, for the folder `dir`: nothing is written yet.
///
/// # Errors
/// What cannot be drawn, or written as a table.
pub fn breaking_points_folder<'a>(
    dir: &'a Path,
    ways: &[PlannedWay],
    tables: &BreakingPointsTables,
    about: &StudyAbout,
) -> Result<Folder<'a>> {
    let mut folder = Folder::new(dir);
    let files = tables.files()?;
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    folder.add_files(files);
    let drawn = draw_breaking_points(ways, tables);
    for (name, title, drawing) in &drawn {
        folder.add_chart(name, title, drawing);
    }
    let note = "Each setting alone is driven to its ends; the interval is that of the place where accuracy is half of its best.";
    let found = vec![
        plain::answer(&sentences(ways, tables)),
        // The first is all others in one.
        plain::charts(&drawn[1..]),
        plain::table(
            "breaks",
            "Breaking points",
            note,
            &breaks_table(tables, 200),
        ),
    ];
    folder.add("report.html", plain_page(about, found, &names));
    Ok(folder)
}

/// How many settings break recognition, where each does, and which do not.
fn sentences(ways: &[PlannedWay], tables: &BreakingPointsTables) -> Vec<String> {
    let place = |row: &BreakingPoint| {
        let at = short_number_rounded(row.breaks_at?);
        Some(format!("{at} ({})", classifier_name(row.classifier)))
    };
    let (mut said, mut unbroken) = (Vec::new(), Vec::new());
    for way in ways {
        let rows = tables.breaking_points.iter();
        let rows = rows.filter(|row| row.way == way.name);
        let places: Vec<String> = rows.filter_map(place).collect();
        match places.is_empty() {
            true => unbroken.push(way.label.as_str()),
            false => said.push(format!(
                "{}: half of the best at {}.",
                way.label,
                places.join(", ")
            )),
        }
    }
    let first = format!(
        "{} of {} settings, driven to their ends, take a classifier to half of its best accuracy or below.",
        said.len(),
        ways.len()
    );
    said.insert(0, first);
    if !unbroken.is_empty() {
        said.push(format!("Nowhere: {}.", unbroken.join("; ")));
    }
    said
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
