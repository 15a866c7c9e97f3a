//! What was found, in sentences.

use super::rows::{DetailCost, DetailRecognition, Measured};
use super::spec::DetailMethod;
use super::study::{COST, RECOGNITION};
use crate::kinds::rows_of;
use crate::report::axis::short_number;
use crate::table::Table;

/// An error of which nothing is felt, mm.
const SMALL_MM: f64 = 0.5;

/// The most exact model; the cheapest of each method that is within half a millimetre; what learning from a model costs.
pub(super) fn answers(tables: &[Table]) -> Vec<String> {
    let costs: Vec<DetailCost> = rows_of(tables, COST.0);
    let models: Vec<&DetailCost> = costs
        .iter()
        .filter(|row| row.measured == Measured::AsItIs && row.n_spheres.is_some())
        .collect();
    let best = models
        .iter()
        .min_by(|a, b| a.error_mm.total_cmp(&b.error_mm));
    let best = best.map(|row| format!("The most exact model of spheres is {}", sentence(row)));
    let fewest = DetailMethod::OF_SPHERES.into_iter().filter_map(|method| {
        let small = models
            .iter()
            .filter(|row| row.method == method && row.error_mm <= SMALL_MM);
        let spheres = |row: &DetailCost| row.n_spheres.unwrap_or(f64::INFINITY);
        let fewest = small.min_by(|a, b| spheres(a).total_cmp(&spheres(b)))?;
        Some(format!(
            "Fewest spheres within {SMALL_MM} mm by {}",
            sentence(fewest)
        ))
    });
    let learned: Vec<DetailRecognition> = rows_of(tables, RECOGNITION.0);
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

fn sentence(row: &DetailCost) -> String {
    format!(
        "{}: {} mm error with {:.0} spheres, {:.0} µs a touch.",
        named(row.method, row.tolerance_mm),
        short_number(row.error_mm),
        row.n_spheres.unwrap_or_default(),
        row.us_per_touch
    )
}
