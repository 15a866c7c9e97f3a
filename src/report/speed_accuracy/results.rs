//! Writes the folder, and says at the end of a run what is in it.

use super::chart::{draw_front_chart, from_to};
use super::points::{ChartKind, ChartPoint, points};
use crate::error::Result;
use crate::report::folder::Folder;
use crate::report::study_tables::{StudyTables, TableFiles, table_file};
use crate::report::terminal::{align_right, plain_table};
use crate::study::advice::cost_in_words;
use crate::study::speed_accuracy::table::SpeedAccuracyTables;
use std::path::{Path, PathBuf};

/// Every point of every chart.
pub const PARETO_FILE: &str = "pareto.csv";

impl StudyTables for SpeedAccuracyTables {
    const OF_PIECES: &'static [&'static str] =
        &["contact.csv", "recognition.csv", "resolution.csv"];
    const OF_ALL: &'static [&'static str] = &[];

    fn files(&self) -> Result<TableFiles> {
        let mut files = Vec::new();
        if !self.contact.is_empty() {
            files.push(table_file("contact.csv", &self.contact)?);
            files.push(table_file("contact_timing.csv", &self.contact_timing)?);
        }
        if !self.recognition.is_empty() {
            files.push(table_file("recognition.csv", &self.recognition)?);
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

/// Writes tables and charts into `dir` (created if missing); returns the paths, tables first.
///
/// Everything is drawn before the first file is written, and each file is whole or not there.
pub fn write_speed_accuracy(dir: &Path, tables: &SpeedAccuracyTables) -> Result<Vec<PathBuf>> {
    let mut folder = Folder::new(dir);
    folder.add_files(tables.files()?);
    let points = points(tables);
    folder.add_table(PARETO_FILE, &points)?;
    for kind in ChartKind::ALL {
        if let Some(drawing) = draw_front_chart(kind, &points) {
            folder.add_chart(kind.name(), kind.title(), &drawing)?;
        }
    }
    folder.write()
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
        let mut front: Vec<&ChartPoint> = of_kind.iter().filter(|p| p.on_front).copied().collect();
        front.sort_by(|a, b| a.cost_us.total_cmp(&b.cost_us));
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
