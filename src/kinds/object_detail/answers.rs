//! What was found, in sentences.

use super::rows::{DetailRecognition, DetailSummary, LevelTime};
use super::spec::DetailMethod;
use super::study::{COST, RECOGNITION};
use crate::kinds::rows_of;
use crate::table::{Table, short_number};

/// A method at a level, and what a touch of it takes.
type Model<'a> = (&'a DetailSummary, &'a LevelTime);

/// A small error, mm.
const SMALL_MM: f64 = 0.5;

/// The most exact model; the cheapest of each method that is within half a millimetre; what learning from a model costs.
pub(super) fn answers(tables: &[Table]) -> Vec<String> {
    let summary: Vec<DetailSummary> = rows_of(tables, COST.name());
    let times: Vec<LevelTime> = rows_of(tables, COST.name());
    let all = summary.iter().zip(&times);
    let models: Vec<Model> = all.filter(|(row, _)| row.n_spheres_median > 0.0).collect();
    let error = |(row, _): &Model| row.error_median_mm;
    let best = models.iter().min_by(|a, b| error(a).total_cmp(&error(b)));
    let best = best.map(|model| format!("The most exact model of spheres is {}", sentence(model)));
    let fewest = DetailMethod::OF_SPHERES.into_iter().filter_map(|method| {
        let of_method = models.iter().filter(|(row, _)| row.method == method);
        let small = of_method.filter(|model| error(model) <= SMALL_MM);
        let spheres = |(row, _): &Model| row.n_spheres_median;
        let fewest = small.min_by(|a, b| spheres(a).total_cmp(&spheres(b)))?;
        let said = sentence(fewest);
        Some(format!("Fewest spheres within {SMALL_MM} mm by {said}"))
    });
    let learned: Vec<DetailRecognition> = rows_of(tables, RECOGNITION.name());
    let misled = learned
        .iter()
        .max_by(|a, b| misled_by(a).total_cmp(&misled_by(b)));
    let misled = misled.filter(|row| misled_by(row) > 0.0).map(|row| {
        format!(
            "A classifier that learned from {} recognises {:.3} of the touches of exact meshes, and {:.3} by its own test.",
            named(row.method, row.tolerance_mm),
            row.accuracy_on_mesh,
            row.accuracy_on_itself
        )
    });
    best.into_iter().chain(fewest).chain(misled).collect()
}

/// How much better a classifier seems to be than it is.
fn misled_by(row: &DetailRecognition) -> f64 {
    row.accuracy_on_itself - row.accuracy_on_mesh
}

/// `packing within 0.1 mm`.
fn named(method: DetailMethod, tolerance_mm: Option<f64>) -> String {
    let within = tolerance_mm.map_or(String::new(), |mm| format!(" within {mm} mm"));
    format!("{}{within}", method.words())
}

fn sentence((row, time): &Model) -> String {
    format!(
        "{}: {} mm error with {:.0} spheres, {:.0} µs a touch.",
        named(row.method, row.tolerance_mm),
        short_number(row.error_median_mm),
        row.n_spheres_median,
        time.us_per_touch_median
    )
}
