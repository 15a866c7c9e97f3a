//! What is charted and said: what spheres buy, what they cost, and what an object's errors cost a classifier that has learned from it.

use super::rows::{DetailRecognition, DetailSummary, LevelTime};
use super::spec::DetailMethod;
use super::study::{COST, ObjectDetailStudy, RECOGNITION};
use super::variants::within;
use crate::kinds::{Findings, rows_of};
use crate::table::{ChartSpec, Table, short_number};

/// What runs along an axis: a part of the chart's name, words of its title, and a column.
type Named = (&'static str, &'static str, &'static str);

/// What is bought.
const FELT: [Named; 2] = [
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

/// What it costs.
const SPHERES: Named = ("spheres", "number of spheres", "n_spheres_median");
const TIME: Named = ("time", "time of a touch", "us_per_touch_median");

/// What was learned, by the error of what was learned from.
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

impl Findings for ObjectDetailStudy {
    /// Errors by what they cost; with what was learned, if anything was.
    fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        let by_cost = [(FELT, SPHERES), (FELT, TIME), (SURFACE, SPHERES)];
        let errors = by_cost.into_iter().flat_map(|(errors, (by, of, x))| {
            errors.map(|(name, words, y)| ChartSpec {
                name: format!("{name}_by_{by}"),
                title: format!("{words} by {of}"),
                note: "Medians over objects with their quartiles.".to_owned(),
                table: COST.name(),
                x: x.to_owned(),
                y: y.to_owned(),
                lines: vec!["method".to_owned()],
                ..ChartSpec::default()
            })
        });
        let has_learned = tables.iter().any(|table| table.file == RECOGNITION.name());
        let learned = LEARNED.into_iter().filter(|_| has_learned);
        let learned = learned.map(|(name, title, y)| ChartSpec {
            name: format!("{name}_by_deflection_error"),
            title: title.to_owned(),
            table: RECOGNITION.name(),
            x: "error_own_contact_median_mm".to_owned(),
            y: y.to_owned(),
            lines: vec!["method".to_owned()],
            panels: Some("classifier".to_owned()),
            ..ChartSpec::default()
        });
        errors.chain(learned).collect()
    }

    /// The most exact model; the cheapest of each method that is within half a millimetre; what learning from a model costs.
    fn answers(&self, tables: &[Table]) -> Vec<String> {
        let summary: Vec<DetailSummary> = rows_of(tables, COST.name());
        let times: Vec<LevelTime> = rows_of(tables, COST.name());
        let mut models: Vec<Model> = summary.into_iter().zip(times).collect();
        models.retain(|(row, _)| row.n_spheres_median > 0.0);
        let best = least(models.iter(), |row| row.error_median_mm);
        let best = best.map(|said| format!("The most exact model of spheres is {said}"));
        let fewest = DetailMethod::OF_SPHERES.into_iter().filter_map(|method| {
            let is_small =
                |row: &DetailSummary| row.method == method && row.error_median_mm <= SMALL_MM;
            let small = models.iter().filter(|(row, _)| is_small(row));
            let said = least(small, |row| row.n_spheres_median)?;
            Some(format!("Fewest spheres within {SMALL_MM} mm by {said}"))
        });
        // How much better a classifier seems to be than it is.
        let misled_by = |row: &DetailRecognition| row.accuracy_on_itself - row.accuracy_on_mesh;
        let learned: Vec<DetailRecognition> = rows_of(tables, RECOGNITION.name());
        let misled = learned
            .iter()
            .max_by(|a, b| misled_by(a).total_cmp(&misled_by(b)));
        let misled = misled.filter(|row| misled_by(row) > 0.0).map(|row| {
            format!(
                "A classifier that learned from {}{} recognises {:.3} of the touches of exact meshes, and {:.3} by its own test.",
                row.method.words(),
                within(row.tolerance_mm),
                row.accuracy_on_mesh,
                row.accuracy_on_itself
            )
        });
        best.into_iter().chain(fewest).chain(misled).collect()
    }
}

/// A method at a level, and what a touch of it takes.
type Model = (DetailSummary, LevelTime);

/// A small error, mm.
const SMALL_MM: f64 = 0.5;

/// The model that has the least of something, in words.
fn least<'a>(
    models: impl Iterator<Item = &'a Model>,
    of: impl Fn(&DetailSummary) -> f64,
) -> Option<String> {
    let (row, time) = models.min_by(|(a, _), (b, _)| of(a).total_cmp(&of(b)))?;
    Some(format!(
        "{}{}: {} mm error with {:.0} spheres, {:.0} µs a touch.",
        row.method.words(),
        within(row.tolerance_mm),
        short_number(row.error_median_mm),
        row.n_spheres_median,
        time.us_per_touch_median
    ))
}
