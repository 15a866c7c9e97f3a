//! The folder of a study of object detail, and what it prints at its end.

use super::object_detail_charts::{
    draw_object_detail_charts, median_time_us, method_name, methods,
};
use crate::error::Result;
use crate::report::axis::{classifier_name, short_number};
use crate::report::folder::Folder;
use crate::report::page::StudyAbout;
use crate::report::page::plain::{self, plain_page};
use crate::report::study_tables::{StudyTables, TableFiles, table_file};
use crate::report::terminal::{align_right, plain_table, wrap};
use crate::study::object_detail::table::{DetailRecognition, DetailSummary, ObjectDetailTables};
use comfy_table::Table;
use std::path::Path;

impl StudyTables for ObjectDetailTables {
    const OF_PIECES: &'static [&'static str] =
        &["object_detail.csv", "object_detail_recognition.csv"];
    const OF_ALL: &'static [&'static str] = &["object_detail_summary.csv"];

    fn files(&self) -> Result<TableFiles> {
        let mut files = vec![
            table_file("object_detail.csv", &self.detail)?,
            table_file("object_detail_summary.csv", &self.summary)?,
            table_file("timing.csv", &self.timing)?,
        ];
        if !self.recognition.is_empty() {
            files.push(table_file(
                "object_detail_recognition.csv",
                &self.recognition,
            )?);
        }
        Ok(files)
    }
}

/// Tables, charts and the page, tables first, for the folder `dir`: nothing is written yet.
///
/// # Errors
/// What cannot be drawn, or written as a table.
pub fn object_detail_folder<'a>(
    dir: &'a Path,
    tables: &ObjectDetailTables,
    about: &StudyAbout,
) -> Result<Folder<'a>> {
    let mut folder = Folder::new(dir);
    let files = tables.files()?;
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    folder.add_files(files);
    let drawn = draw_object_detail_charts(tables);
    for (name, title, drawing) in &drawn {
        folder.add_chart(name, title, drawing);
    }
    let learned = recognition_table(&tables.recognition, WIDE);
    let found = vec![
        plain::answer(&sentences(tables)),
        plain::table("models", "Models", NOTE, &summary_table(tables, WIDE)),
        plain::charts(&drawn),
        plain::table("recognition", "Recognition", LEARNED, &learned),
    ];
    folder.add("report.html", plain_page(about, found, &names));
    Ok(folder)
}

/// The most exact model, and what each takes to be within half a millimetre.
fn sentences(tables: &ObjectDetailTables) -> Vec<String> {
    let error = |row: &DetailSummary| row.error_median_mm;
    let sentence = |row: &DetailSummary| {
        format!(
            "{}: {} mm error with {:.0} spheres, {:.0} µs a touch.",
            method_name(row.method),
            short_number(error(row)),
            row.n_spheres_median,
            median_time_us(tables, row.method, row.tolerance_mm)
        )
    };
    let models = tables
        .summary
        .iter()
        .filter(|row| row.n_spheres_median > 0.0);
    let best = models.clone().min_by(|a, b| error(a).total_cmp(&error(b)));
    let mut sentences: Vec<String> = best
        .map(|row| format!("The most exact model of spheres is {}", sentence(row)))
        .into_iter()
        .collect();
    for method in methods(tables.summary.iter().map(|row| row.method)) {
        let good = models
            .clone()
            .filter(|row| row.method == method && error(row) <= 0.5);
        let fewest = good.min_by(|a, b| a.n_spheres_median.total_cmp(&b.n_spheres_median));
        sentences
            .extend(fewest.map(|row| format!("Fewest spheres within 0.5 mm by {}", sentence(row))));
    }
    sentences
}

const NOTE: &str = "Medians over objects; error is the mean over touched taxels of |deflection − that of the exact mesh|, worst \
    that of the worst object, − offset with the best constant depth taken off, × packing the ratio of that to the packing's.";

const LEARNED: &str = "Classifiers that learned from models, tested on the exact meshes and on the models themselves.";

/// Letters a line where nothing has to fit a terminal.
const WIDE: usize = 200;

/// A line a method and level: medians over objects. Lines are at most about `width` letters long.
pub fn object_detail_summary(tables: &ObjectDetailTables, width: usize) -> String {
    let table = summary_table(tables, width);
    let mut text = format!("{}\n\n{table}\n", wrap(NOTE, width).join("\n"));
    if !tables.recognition.is_empty() {
        text += &recognition_text(&tables.recognition, width);
    }
    text
}

fn summary_table(tables: &ObjectDetailTables, width: usize) -> Table {
    let mut table = plain_table(width);
    table.set_header([
        "model",
        "within mm",
        "spheres",
        "surface mm",
        "error mm",
        "worst mm",
        "− offset mm",
        "× packing",
        "µs a touch",
    ]);
    for row in &tables.summary {
        let optional = |value: Option<f64>| value.map_or(String::new(), short_number);
        table.add_row([
            method_name(row.method).to_owned(),
            optional(row.tolerance_mm),
            format!("{:.0}", row.n_spheres_median),
            short_number(row.surface_error_median_mm),
            short_number(row.error_median_mm),
            short_number(row.error_worst_mm),
            short_number(row.error_after_offset_median_mm),
            optional(row.times_packing),
            format!(
                "{:.0}",
                median_time_us(tables, row.method, row.tolerance_mm)
            ),
        ]);
    }
    align_right(&mut table, 1..9);
    table
}

/// What was recognised by classifiers that have learned from models.
fn recognition_text(rows: &[DetailRecognition], width: usize) -> String {
    let table = recognition_table(rows, width);
    let n_capped: usize = rows.iter().map(|row| row.n_capped).sum();
    let mut text = format!("{}\n\n{table}\n", wrap(LEARNED, width).join("\n"));
    if n_capped > 0 {
        text += &format!("{n_capped} of their problems stopped at the solver's iteration cap\n");
    }
    text
}

fn recognition_table(rows: &[DetailRecognition], width: usize) -> Table {
    let mut table = plain_table(width);
    table.set_header([
        "classifier",
        "learned from",
        "within mm",
        "error mm",
        "accuracy on meshes",
        "on itself",
    ]);
    for row in rows {
        table.add_row([
            classifier_name(row.classifier).to_owned(),
            method_name(row.method).to_owned(),
            row.tolerance_mm.map_or(String::new(), short_number),
            short_number(row.error_own_contact_median_mm),
            format!(
                "{:.3} [{:.3}, {:.3}]",
                row.accuracy_on_mesh, row.accuracy_on_mesh_low, row.accuracy_on_mesh_high
            ),
            format!("{:.3}", row.accuracy_on_itself),
        ]);
    }
    align_right(&mut table, 2..6);
    table
}
