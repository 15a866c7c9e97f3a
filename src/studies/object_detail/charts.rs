//! Charts and answers of an object-detail study: deflection errors and costs of models, and the accuracy of classifiers trained on models.

use crate::report::advice::Candidates;
use crate::studies::object_detail::rows::*;
use crate::studies::prelude::*;

/// Charts of the deflection error by cost, and of the accuracy of classifiers against the deflection error of their training models.
pub(super) const CHARTS: &[Chart] = &[
    error("deflection_error_by_spheres", "error_median_mm", SPHERES),
    error(
        "deflection_error_after_offset_by_spheres",
        "error_after_offset_median_mm",
        SPHERES,
    ),
    error("deflection_error_by_time", "error_median_mm", TIME),
    error(
        "deflection_error_after_offset_by_time",
        "error_after_offset_median_mm",
        TIME,
    ),
    error(
        "surface_error_by_spheres",
        "surface_error_median_mm",
        SPHERES,
    ),
    error(
        "surface_error_max_by_spheres",
        "surface_error_max_median_mm",
        SPHERES,
    ),
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
];

const SPHERES: &str = "n_spheres_median";
const TIME: &str = "us_per_touch_median";

const fn error(name: &'static str, y: &'static str, x: &'static str) -> Chart {
    Chart {
        table: COST.name(),
        name,
        note: "Medians over objects with their quartiles.",
        x,
        y,
        lines: &["method"],
        ..Chart::LINES
    }
}

const fn learned(name: &'static str, title: &'static str, y: &'static str) -> Chart {
    Chart {
        table: RECOGNITION.name(),
        name,
        title,
        x: "error_own_contact_median_mm",
        y,
        lines: &["method"],
        panels: Some("classifier"),
        ..Chart::LINES
    }
}

/// Returns the answers: the models of spheres with the least error, and those that cost the fewest spheres.
pub(super) fn answers(tables: &[Table]) -> Vec<String> {
    let costs = &tables[3];
    let models = Candidates::of_columns(costs, "error_median_mm", SPHERES);
    models.map_or_else(Vec::new, |mut models| {
        models.retain(|row| costs.number(SPHERES, row) > 0.0);
        models.sentences()
    })
}
