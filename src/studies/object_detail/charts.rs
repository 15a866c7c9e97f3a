//! Charts and answers of an object-detail study: deflection errors and costs of models, and the accuracy of classifiers trained on models.

use crate::studies::object_detail::measured::within;
use crate::studies::object_detail::rows::RECOGNITION;
use crate::table::{ChartSpec, Table, short_number};

/// Chart axis: a part of the chart's file name, the words for the title, and the name of the table column.
type Named = (&'static str, &'static str, &'static str);

/// Chart axes that show deflection errors.
const DEFLECTION_ERRORS: [Named; 2] = [
    (
        "deflection_error",
        "Error of what the skin feels",
        "error_median_mm",
    ),
    (
        "deflection_error_after_offset",
        "Error of what the skin feels after the best constant offset",
        "error_after_offset_median_mm",
    ),
];
/// Chart axes that show distances between the surfaces of model and mesh.
const SURFACE: [Named; 2] = [
    (
        "surface_error",
        "Mean distance between spheres and mesh",
        "surface_error_median_mm",
    ),
    (
        "surface_error_max",
        "Largest distance between spheres and mesh",
        "surface_error_max_median_mm",
    ),
];

/// Chart axis that shows the number of spheres of a model.
const SPHERES: Named = ("spheres", "number of spheres", "n_spheres_median");
/// Chart axis that shows the computing time per touch.
const TIME: Named = ("time", "time of a touch", "us_per_touch_median");

/// Chart axes for the accuracy of classifiers against the deflection error of their training models.
const LEARNED: [Named; 2] = [
    (
        "recognition",
        "Accuracy on the exact meshes by the error of the models that were learned from",
        "accuracy_on_mesh",
    ),
    (
        "recognition_of_models",
        "Accuracy on the models themselves by their error",
        "accuracy_on_itself",
    ),
];

/// Returns charts of the deflection error by cost. If classifiers were trained, charts of their accuracy follow.
pub(super) fn charts(tables: &[Table]) -> Vec<ChartSpec> {
    let by_cost = [
        (DEFLECTION_ERRORS, SPHERES),
        (DEFLECTION_ERRORS, TIME),
        (SURFACE, SPHERES),
    ];
    let errors = by_cost.into_iter().flat_map(|(errors, (by, of, x))| {
        errors.map(|(name, words, y)| {
            let (name, title) = (format!("{name}_by_{by}"), format!("{words} by {of}"));
            ChartSpec {
                note: "Medians over objects with their quartiles.".to_owned(),
                lines: vec!["method".to_owned()],
                ..tables[3].chart(name, title, (y, x))
            }
        })
    });
    let by_error = |learned: &Table| {
        LEARNED.map(|(name, title, y)| ChartSpec {
            lines: vec!["method".to_owned()],
            panels: Some("classifier".to_owned()),
            ..learned.chart(
                format!("{name}_by_deflection_error"),
                title,
                (y, "error_own_contact_median_mm"),
            )
        })
    };
    let learned = learned(tables).into_iter().flat_map(by_error);
    errors.chain(learned).collect()
}

/// Returns the answers: the most exact model, the cheapest models within half a millimetre, and the loss of accuracy by training on models.
pub(super) fn answers(tables: &[Table]) -> Vec<String> {
    let costs = &tables[3];
    let rows = 0..costs.n_rows;
    let models: Vec<usize> = rows
        .filter(|&row| costs.number("n_spheres_median", row) > 0.0)
        .collect();
    let best = least(costs, models.iter().copied(), "error_median_mm");
    let best = best.map(|said| format!("The most exact model of spheres is {said}"));
    let fewest = OF_SPHERES.into_iter().filter_map(|method| {
        let small = models.iter().copied().filter(|&row| {
            let error = costs.number("error_median_mm", row);
            costs.word("method", row) == method && error <= SMALL_MM
        });
        let said = least(costs, small, "n_spheres_median")?;
        Some(format!("Fewest spheres within {SMALL_MM} mm by {said}"))
    });
    let misled = learned(tables).and_then(misled_most);
    best.into_iter().chain(fewest).chain(misled).collect()
}

/// Returns the table of trained classifiers; `None` if the study has trained none.
fn learned(tables: &[Table]) -> Option<&Table> {
    tables.iter().find(|table| table.file == RECOGNITION.name())
}

/// Names of the methods that represent a mesh by spheres.
const OF_SPHERES: [&str; 4] = [
    "packing",
    "vertex_spheres",
    "decimated_vertex_spheres",
    "medial_spheres",
];

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

/// Deflection error below which a model is considered exact enough, mm.
const SMALL_MM: f64 = 0.5;

/// Returns a description of the model with the smallest value in the column `of`; `models` are the table rows to compare.
fn least(costs: &Table, models: impl Iterator<Item = usize>, of: &str) -> Option<String> {
    let number = |column: &str, row: usize| costs.number(column, row);
    let row = models.min_by(|&a, &b| number(of, a).total_cmp(&number(of, b)))?;
    Some(format!(
        "{}: {} mm error with {:.0} spheres, {:.0} µs a touch.",
        model_words(costs, row),
        short_number(number("error_median_mm", row)),
        number("n_spheres_median", row),
        number("us_per_touch_median", row)
    ))
}
