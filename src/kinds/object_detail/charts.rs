//! What is charted: what spheres buy, what they cost, and what an object's errors cost a classifier that has learned from it.

use super::study::{COST, RECOGNITION};
use crate::table::{ChartSpec, Shown, Table, Value};

/// Errors by what they cost; with what was learned, if anything was.
pub(super) fn charts(tables: &[Table]) -> Vec<ChartSpec> {
    let by_cost = |name: &str, title: &str, compared: &str, x: &str| ChartSpec {
        name: name.to_owned(),
        title: title.to_owned(),
        note: "Medians over objects with the band of their quartiles.".to_owned(),
        table: COST.0,
        shown: vec![Shown {
            column: "compared".to_owned(),
            value: Value::Word(compared.to_owned()),
        }],
        x: x.to_owned(),
        y: "error_mm".to_owned(),
        lines: vec!["method".to_owned()],
        panels: Some("measured".to_owned()),
        ..ChartSpec::default()
    };
    let mut charts = vec![
        by_cost(
            "deflection_error_by_spheres",
            "Error of what the skin feels by number of spheres",
            "deflection",
            "n_spheres",
        ),
        by_cost(
            "deflection_error_by_time",
            "Error of what the skin feels by time of a touch",
            "deflection",
            "us_per_touch",
        ),
        by_cost(
            "surface_error_by_spheres",
            "Distance between spheres and mesh by number of spheres",
            "surface",
            "n_spheres",
        ),
    ];
    let learned = |name: &str, title: &str, y: &str| ChartSpec {
        name: name.to_owned(),
        title: title.to_owned(),
        note: "Learned from models, by how wrong what they feel is.".to_owned(),
        table: RECOGNITION.0,
        x: "error_own_contact_median_mm".to_owned(),
        y: y.to_owned(),
        lines: vec!["method".to_owned()],
        panels: Some("classifier".to_owned()),
        ..ChartSpec::default()
    };
    if tables.iter().any(|table| table.file == RECOGNITION.0) {
        charts.extend([
            learned(
                "recognition_by_deflection_error",
                "Accuracy on the exact meshes by the error of the models that were learned from",
                "accuracy_on_mesh",
            ),
            learned(
                "recognition_of_models_by_deflection_error",
                "Accuracy on the models themselves by their error",
                "accuracy_on_itself",
            ),
        ]);
    }
    charts
}
