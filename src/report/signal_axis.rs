//! What happens to the signal, on axes and in words.

use crate::report::axis::Axis;
use crate::study::strength_columns;
use crate::study::table::Cell;
use crate::table::Column;

/// A signal that nothing happens to.
pub(super) const IDEAL: &str = "ideal";
/// The same in a sentence.
pub(super) const IDEAL_SIGNAL: &str = "an ideal signal";

/// All that happens to the signal in a cell: `noise 5 %, gain mismatch 20 %`.
pub(super) fn words(cell: &Cell) -> String {
    let noise = (cell.noise_std != 0.0).then(|| Axis::Noise.phrase(cell));
    let smoothing = (cell.smoothing_mm != 0.0).then(|| Axis::Smoothing.phrase(cell));
    let is_there = |column: &&Column| cell.strengths.of(&column.name).unwrap_or(0.0) != 0.0;
    let errors = strength_columns().iter().filter(is_there);
    let errors = errors.map(|column| Axis::Column(column).phrase(cell));
    let all: Vec<String> = noise.into_iter().chain(smoothing).chain(errors).collect();
    match all.is_empty() {
        true => IDEAL.to_owned(),
        false => all.join(", "),
    }
}
