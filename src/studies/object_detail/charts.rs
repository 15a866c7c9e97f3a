//! Charts and answers of an object-detail study: deflection errors and costs of models, and the accuracy of classifiers trained on models.

use crate::studies::object_detail::measured::within;
use crate::studies::object_detail::rows::*;
use crate::studies::prelude::*;
use crate::table::short_number;

/// Start of the file name and column of each deflection error of models.
const ERRORS: [(&str, &str); 2] = [
    ("deflection_error", "error_median_mm"),
    (
        "deflection_error_after_offset",
        "error_after_offset_median_mm",
    ),
];

/// Start of the file name and column of each distance between the surfaces of models and meshes.
const SURFACE_ERRORS: [(&str, &str); 2] = [
    ("surface_error", "surface_error_median_mm"),
    ("surface_error_max", "surface_error_max_median_mm"),
];

/// Charts of classifiers against the deflection error of their training models: file name, title and column along y.
const LEARNED: [[&str; 3]; 2] = [
    [
        "recognition_by_deflection_error",
        "Accuracy on the exact meshes by the error of the models that were learned from",
        "accuracy_on_mesh",
    ],
    [
        "recognition_of_models_by_deflection_error",
        "Accuracy on the models themselves by their error",
        "accuracy_on_itself",
    ],
];

/// Returns charts of the deflection error by cost. If classifiers were trained, charts of their accuracy follow.
pub(super) fn charts(tables: &[Table]) -> Vec<ChartSpec> {
    let by = |errors: [(&str, &str); 2], cost: &str, x: &str| {
        errors.map(|(name, y)| ChartSpec {
            note: "Medians over objects with their quartiles.".to_owned(),
            lines: vec!["method".to_owned()],
            ..tables[3].chart(format!("{name}_by_{cost}"), "{y} by {x}", (y, x))
        })
    };
    let errors = [
        by(ERRORS, "spheres", "n_spheres_median"),
        by(ERRORS, "time", "us_per_touch_median"),
        by(SURFACE_ERRORS, "spheres", "n_spheres_median"),
    ];
    let by_error = |learned: &Table| {
        LEARNED.map(|[name, title, y]| ChartSpec {
            lines: vec!["method".to_owned()],
            panels: Some("classifier".to_owned()),
            ..learned.chart(name, title, (y, "error_own_contact_median_mm"))
        })
    };
    let learned = learned(tables).into_iter().flat_map(by_error);
    errors.into_iter().flatten().chain(learned).collect()
}

/// Returns the answers: the most exact model, and the loss of accuracy by training on models.
pub(super) fn answers(tables: &[Table]) -> Vec<String> {
    let costs = &tables[3];
    let number = |column: &str, row: usize| costs.number(column, row);
    let models = (0..costs.n_rows).filter(|&row| number("n_spheres_median", row) > 0.0);
    let error = |row: usize| number("error_median_mm", row);
    let best = models.min_by(|&a, &b| error(a).total_cmp(&error(b)));
    let best = best.map(|row| {
        format!(
            "The most exact model of spheres is {}: {} mm error with {:.0} spheres, {:.0} µs a touch.",
            model_words(costs, row),
            short_number(error(row)),
            number("n_spheres_median", row),
            number("us_per_touch_median", row)
        )
    });
    let misled = learned(tables).and_then(misled_most);
    best.into_iter().chain(misled).collect()
}

/// Returns the table of trained classifiers; `None` if the study has trained none.
fn learned(tables: &[Table]) -> Option<&Table> {
    tables.iter().find(|table| table.file == RECOGNITION.name())
}

/// Returns a sentence on the classifier with the largest drop in accuracy from its training models to the exact meshes. Returns `None` if no classifier has a
/// higher accuracy on its models.
fn misled_most(learned: &Table) -> Option<String> {
    let shares = |row: usize| {
        ["accuracy_on_mesh", "accuracy_on_itself"].map(|share| learned.number(share, row))
    };
    let by = |row: usize| shares(row)[1] - shares(row)[0];
    let most = (0..learned.n_rows).max_by(|&a, &b| by(a).total_cmp(&by(b)));
    let row = most.filter(|&row| by(row) > 0.0)?;
    let ([on_mesh, on_itself], model) = (shares(row), model_words(learned, row));
    Some(format!(
        "A classifier that learned from {model} recognises {on_mesh:.3} of the touches of exact meshes, and {on_itself:.3} by its own test."
    ))
}

/// Returns the name of a model, such as `packing within 0.5 mm`.
fn model_words(table: &Table, row: usize) -> String {
    let tolerance_mm = Some(table.number("tolerance_mm", row)).filter(|mm| !mm.is_nan());
    table.words("method", row) + &within(tolerance_mm)
}
