//! Missing readings: NaN and infinite numbers.

use crate::statistics::quantile::quantile;
use ndarray::{Array2, ArrayView2};

/// Returns the number of readings of each taxel that are NaN or infinite.
pub fn count_missing(frames: ArrayView2<f64>) -> Vec<usize> {
    let mut counts = vec![0; frames.ncols()];
    for frame in frames.rows() {
        for (count, reading) in counts.iter_mut().zip(frame) {
            *count += usize::from(!reading.is_finite());
        }
    }
    counts
}

/// Replaces missing readings by the median of the taxel's other readings; by 0 if the taxel has no readings. `counts` are the numbers of missing readings of
/// each taxel.
pub fn fill_missing(frames: &mut Array2<f64>, counts: &[usize]) {
    for (taxel, _) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let mut column = frames.column_mut(taxel);
        let mut known: Vec<f64> = column.iter().copied().filter(|x| x.is_finite()).collect();
        let median = quantile(&mut known, 0.5);
        column.mapv_inplace(|x| if x.is_finite() { x } else { median });
    }
}
