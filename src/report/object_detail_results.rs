//! The folder of a study of object detail, and what it prints at its end.

use super::object_detail_charts::{draw_object_detail_charts, median_time_us, method_name};
use crate::error::Result;
use crate::report::axis::{classifier_name, short_number};
use crate::report::folder::Folder;
use crate::report::terminal::{align_right, plain_table};
use crate::study::object_detail::table::{DetailRecognition, ObjectDetailTables};
use std::path::{Path, PathBuf};

/// Writes tables and charts into `dir` (created if missing); returns the paths, tables first.
///
/// Everything is drawn before the first file is written, and each file is whole or not there.
pub fn write_object_detail(dir: &Path, tables: &ObjectDetailTables) -> Result<Vec<PathBuf>> {
    let mut folder = Folder::new(dir);
    folder.add_table("object_detail.csv", &tables.detail)?;
    folder.add_table("object_detail_summary.csv", &tables.summary)?;
    folder.add_table("timing.csv", &tables.timing)?;
    if !tables.recognition.is_empty() {
        folder.add_table("object_detail_recognition.csv", &tables.recognition)?;
    }
    for (name, title, drawing) in draw_object_detail_charts(tables) {
        folder.add_chart(&name, &title, &drawing)?;
    }
    folder.write()
}

/// A line a method and level: medians over objects. Lines are at most about `width` letters long.
pub fn object_detail_summary(tables: &ObjectDetailTables, width: usize) -> String {
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
    let mut text = format!(
        "Medians over objects; error is the mean over touched taxels of |deflection − that of the exact mesh|, worst\n\
        that of the worst object, − offset with the best constant depth taken off, × packing the ratio of that to the packing's.\n\n{table}\n"
    );
    if !tables.recognition.is_empty() {
        text += &recognition_text(&tables.recognition, width);
    }
    text
}

/// What was recognised by classifiers that have learned from models.
fn recognition_text(rows: &[DetailRecognition], width: usize) -> String {
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
    let n_capped: usize = rows.iter().map(|row| row.n_capped).sum();
    let mut text = format!(
        "Classifiers that learned from models, tested on the exact meshes and on the models themselves:\n\n{table}\n"
    );
    if n_capped > 0 {
        text += &format!("{n_capped} of their problems stopped at the solver's iteration cap\n");
    }
    text
}
