//! The folder of a study of object detail, and what it prints at its end.

use super::object_detail_charts::{draw_object_detail_charts, median_time_us, method_name};
use crate::error::Result;
use crate::report::axis::short_number;
use crate::report::folder::Folder;
use crate::report::terminal::{align_right, plain_table};
use crate::study::object_detail::table::ObjectDetailTables;
use std::path::{Path, PathBuf};

/// Writes tables and charts into `dir` (created if missing); returns the paths, tables first.
///
/// Everything is drawn before the first file is written, and each file is whole or not there.
pub fn write_object_detail(dir: &Path, tables: &ObjectDetailTables) -> Result<Vec<PathBuf>> {
    let mut folder = Folder::new(dir);
    folder.add_table("object_detail.csv", &tables.detail)?;
    folder.add_table("object_detail_summary.csv", &tables.summary)?;
    folder.add_table("timing.csv", &tables.timing)?;
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
    format!(
        "Medians over objects; error is the mean over touched taxels of |deflection − that of the exact mesh|, worst\n\
        that of the worst object, − offset with the best constant depth taken off, × packing the ratio of that to the packing's.\n\n{table}\n"
    )
}
