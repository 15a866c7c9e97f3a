//! Writes the folder, and says at the end of a run what is in it.

use super::chart::{draw_front_chart, from_to};
use super::points::{ChartKind, ChartPoint, points};
use crate::error::Result;
use crate::report::folder::Folder;
use crate::report::page::StudyAbout;
use crate::report::page::plain::{self, plain_page};
use crate::report::study_tables::{StudyTables, TableFiles, table_file};
use crate::report::terminal::{align_right, plain_table};
use crate::study::advice::cost_in_words;
use crate::study::speed_accuracy::table::SpeedAccuracyTables;
use comfy_table::Table;
use std::path::Path;

/// Every point of every chart.
pub const PARETO_FILE: &str = "pareto.csv";
/// Chains from touch to answer, and how often they are right.
pub(in crate::report) const CHAINS_FILE: &str = "recognition.csv";

impl StudyTables for SpeedAccuracyTables {
    const OF_PIECES: &'static [&'static str] = &["contact.csv", CHAINS_FILE, "resolution.csv"];
    const OF_ALL: &'static [&'static str] = &[];

    fn files(&self) -> Result<TableFiles> {
        let mut files = Vec::new();
        if !self.contact.is_empty() {
            files.push(table_file("contact.csv", &self.contact)?);
            files.push(table_file("contact_timing.csv", &self.contact_timing)?);
        }
        if !self.recognition.is_empty() {
            files.push(table_file(CHAINS_FILE, &self.recognition)?);
            files.push(table_file(
                "recognition_timing.csv",
                &self.recognition_timing,
            )?);
        }
        if !self.resolution.is_empty() {
            files.push(table_file("resolution.csv", &self.resolution)?);
            files.push(table_file(
                "resolution_timing.csv",
                &self.resolution_timing,
            )?);
        }
        Ok(files)
    }
}

/// Tables, charts and the page, tables first, for the folder `dir`: nothing is written yet.
///
/// # Errors
/// What cannot be drawn, or written as a table.
pub fn speed_accuracy_folder<'a>(
    dir: &'a Path,
    tables: &SpeedAccuracyTables,
    about: &StudyAbout,
) -> Result<Folder<'a>> {
    let mut folder = Folder::new(dir);
    let tables_made = tables.files()?;
    let mut files: Vec<&str> = tables_made.iter().map(|(name, _)| *name).collect();
    folder.add_files(tables_made);
    let points = points(tables);
    folder.add_table(PARETO_FILE, &points)?;
    files.push(PARETO_FILE);
    let mut drawn = Vec::new();
    for kind in ChartKind::ALL {
        if let Some(drawing) = draw_front_chart(kind, &points) {
            folder.add_chart(kind.name(), kind.title(), &drawing);
            drawn.push((kind.name().to_owned(), kind.title().to_owned(), drawing));
        }
    }
    let note =
        "What no other setting of its chart beats, cheapest first; pareto.csv has every point.";
    let found = vec![
        plain::answer(&sentences(&points)),
        plain::charts(&drawn),
        plain::table("fronts", "Fronts", note, &fronts_table(&points)),
    ];
    folder.add("report.html", plain_page(about, found, &files));
    Ok(folder)
}

/// The two ends of each front.
fn sentences(points: &[ChartPoint]) -> Vec<String> {
    let of_kind = |kind: ChartKind| {
        let mut front = front_of(points, kind);
        // Of what was touched beside, the table and the chart tell.
        front.retain(|point| !point.is_of_scans());
        let (first, last) = (front.first()?, front.last()?);
        let end = |point: &ChartPoint| format!("{} ({})", point.setting, kind.at_cost(point));
        let n = points.iter().filter(|point| point.chart == kind).count();
        let about = match kind {
            ChartKind::Contact => "Contact, from the fastest to the most accurate",
            ChartKind::Decision => "Decisions, from the fastest to the best",
            ChartKind::Training => "Training, from the fastest to the best",
            // Each group has a front of its own.
            ChartKind::Resolution => return None,
        };
        Some(format!(
            "{about} of {n} settings: {} … {}.",
            end(first),
            end(last)
        ))
    };
    ChartKind::ALL.into_iter().filter_map(of_kind).collect()
}

/// What no other point of a chart beats, cheapest first.
fn front_of(points: &[ChartPoint], kind: ChartKind) -> Vec<&ChartPoint> {
    let of_kind = points
        .iter()
        .filter(|point| point.chart == kind && point.on_front);
    let mut front: Vec<&ChartPoint> = of_kind.collect();
    front.sort_by(|a, b| a.cost_us.total_cmp(&b.cost_us));
    front
}

fn fronts_table(points: &[ChartPoint]) -> Table {
    let mut table = plain_table(200);
    table.set_header(["chart", "on the front", "cost", "value", "measured by"]);
    for kind in ChartKind::ALL {
        for point in front_of(points, kind) {
            table.add_row([
                kind.value_name().to_owned(),
                point.setting.clone(),
                cost_in_words(point.cost_us),
                kind.value_words(point),
                point.source.clone(),
            ]);
        }
    }
    table
}

/// The fronts, a line a point. Lines are at most about `width` letters long.
pub fn speed_accuracy_summary(tables: &SpeedAccuracyTables, width: usize) -> String {
    let points = points(tables);
    let mut text = String::new();
    for kind in ChartKind::ALL {
        let of_kind: Vec<&ChartPoint> = points.iter().filter(|p| p.chart == kind).collect();
        let Some(range) = from_to(&of_kind) else {
            continue;
        };
        let front = front_of(&points, kind);
        let mut table = plain_table(width);
        table.set_header(["on the front", "cost", kind.value_name()]);
        for point in front {
            let cost = cost_in_words(point.cost_us);
            let value = format!("{:.4}", point.value);
            table.add_row([point.setting.clone(), cost, value]);
        }
        align_right(&mut table, 1..3);
        let (title, n) = (kind.title(), of_kind.len());
        text += &format!("{title}\n{n} settings, {range}\n\n{table}\n\n");
    }
    text
}
