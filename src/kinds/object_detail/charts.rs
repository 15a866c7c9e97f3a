//! What is charted: what spheres buy, what they cost, and what an object's errors cost a classifier that has learned from it.

use super::study::{COST, RECOGNITION};
use crate::table::{ChartSpec, Table};

/// Each chart: its name, its title, what runs along x and along y.
type Named = (&'static str, &'static str, &'static str, &'static str);

/// Errors by what they cost.
const ERRORS: [Named; 6] = [
    (
        "deflection_error_by_spheres",
        "Error of what the skin feels by number of spheres",
        "n_spheres_median",
        "error_median_mm",
    ),
    (
        "deflection_error_after_offset_by_spheres",
        "Error of what the skin feels after the best constant offset by number of spheres",
        "n_spheres_median",
        "error_after_offset_median_mm",
    ),
    (
        "deflection_error_by_time",
        "Error of what the skin feels by time of a touch",
        "us_per_touch_median",
        "error_median_mm",
    ),
    (
        "deflection_error_after_offset_by_time",
        "Error of what the skin feels after the best constant offset by time of a touch",
        "us_per_touch_median",
        "error_after_offset_median_mm",
    ),
    (
        "surface_error_by_spheres",
        "Mean distance between spheres and mesh by number of spheres",
        "n_spheres_median",
        "surface_error_median_mm",
    ),
    (
        "surface_error_max_by_spheres",
        "Largest distance between spheres and mesh by number of spheres",
        "n_spheres_median",
        "surface_error_max_median_mm",
    ),
];

/// What was learned, by the error of what was learned from.
const LEARNED: [Named; 2] = [
    (
        "recognition_by_deflection_error",
        "Accuracy on the exact meshes by the error of the models that were learned from",
        "error_own_contact_median_mm",
        "accuracy_on_mesh",
    ),
    (
        "recognition_of_models_by_deflection_error",
        "Accuracy on the models themselves by their error",
        "error_own_contact_median_mm",
        "accuracy_on_itself",
    ),
];

/// Errors by what they cost; with what was learned, if anything was.
pub(super) fn charts(tables: &[Table]) -> Vec<ChartSpec> {
    let chart = |table: &'static str, (name, title, x, y): Named| ChartSpec {
        name: name.to_owned(),
        title: title.to_owned(),
        table,
        x: x.to_owned(),
        y: y.to_owned(),
        lines: vec!["method".to_owned()],
        ..ChartSpec::default()
    };
    let errors = ERRORS.map(|named| ChartSpec {
        note: "Medians over objects with their quartiles.".to_owned(),
        ..chart(COST.name(), named)
    });
    let has_learned = tables.iter().any(|table| table.file == RECOGNITION.name());
    let learned = LEARNED.into_iter().filter(|_| has_learned);
    let learned = learned.map(|named| ChartSpec {
        panels: Some("classifier".to_owned()),
        ..chart(RECOGNITION.name(), named)
    });
    errors.into_iter().chain(learned).collect()
}
