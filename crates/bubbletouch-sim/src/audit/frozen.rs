//! Frozen taxels: taxels that keep exactly one reading for some time while the taxels on both sides are touched.
//!
//! Outside such a time, a taxel between two touched taxels is touched too, with a frequency q that depends on the class of the touch. If the taxel worked during
//! a run of m such frames, it would remain at one reading with the probability (1 − q)ᵐ. Readings at the upper end of the taxel's range are saturated, not frozen.

use ndarray::{ArrayView1, ArrayView2};
use std::collections::BTreeMap;

/// Minimum number of frames of a run.
const MIN_RUN: usize = 10;
/// Minimum number of frames of a run in which the taxel lies between two touched taxels.
const MIN_BETWEEN: usize = 3;

/// Time during which a taxel keeps its reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrozenTaxel {
    /// Index of the taxel.
    pub taxel: usize,
    /// First frame of the run.
    pub first: usize,
    /// Number of frames of the run.
    pub n_frames: usize,
}

/// Finds frozen taxels of a grid. A reading above `touched` is contact. `labels` contains the class of each frame. `is_counted` is false for taxels that are
/// constant in all frames. `significance` is the probability of reporting any taxel that works.
pub fn frozen_taxels(
    frames: ArrayView2<f64>,
    (rows, columns): (usize, usize),
    labels: &[usize],
    touched: f64,
    is_counted: &[bool],
    significance: f64,
) -> Vec<FrozenTaxel> {
    let mut runs = Vec::new();
    let mut n_runs = 0_usize;
    for taxel in (0..frames.ncols()).filter(|&taxel| is_counted[taxel]) {
        let (y, x) = (taxel / columns, taxel % columns);
        let pairs = [
            (x > 0 && x + 1 < columns).then(|| [taxel - 1, taxel + 1]),
            (y > 0 && y + 1 < rows).then(|| [taxel - columns, taxel + columns]),
        ];
        let pairs = pairs.iter().flatten();
        let pairs: Vec<_> = pairs
            .map(|pair| pair.map(|taxel| frames.column(taxel)))
            .collect();
        let is_between = |&row: &usize| {
            let mut pairs = pairs.iter();
            pairs.any(|pair| pair.iter().all(|readings| readings[row] > touched))
        };
        let between: Vec<usize> = (0..frames.nrows()).filter(is_between).collect();
        let readings = frames.column(taxel);
        let largest = readings.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut first = 0;
        for row in 1..=readings.len() {
            if row < readings.len() && readings[row] == readings[row - 1] {
                continue;
            }
            let run = std::mem::replace(&mut first, row)..row;
            if run.len() < MIN_RUN {
                continue;
            }
            n_runs += 1;
            let own = readings[run.start];
            let is_saturated = own == largest && own > touched;
            let inside = [run.start, run.end].map(|end| between.partition_point(|&row| row < end));
            if !is_saturated && inside[1] - inside[0] >= MIN_BETWEEN {
                let log_p = log_probability(readings, &between, inside, labels);
                runs.push((
                    log_p,
                    FrozenTaxel {
                        taxel,
                        first: run.start,
                        n_frames: run.len(),
                    },
                ));
            }
        }
    }
    let bound = (significance / n_runs.max(1) as f64).ln();
    runs.retain(|(log_p, _)| *log_p <= bound);
    runs.into_iter().map(|(_, run)| run).collect()
}

/// Returns the logarithm of the probability that a working taxel keeps its reading in the frames `between[inside[0]..inside[1]]`. The frequency of this reading
/// follows from the other frames of each class; frames of a class without other frames do not count.
fn log_probability(
    readings: ArrayView1<f64>,
    between: &[usize],
    inside: [usize; 2],
    labels: &[usize],
) -> f64 {
    let own = readings[between[inside[0]]];
    let mut outside = BTreeMap::<usize, [f64; 2]>::new();
    for &row in between[..inside[0]].iter().chain(&between[inside[1]..]) {
        let [n, n_equal] = outside.entry(labels[row]).or_default();
        *n += 1.0;
        *n_equal += f64::from(u8::from(readings[row] == own));
    }
    let rows = between[inside[0]..inside[1]].iter();
    let known = rows.filter_map(|&row| outside.get(&labels[row]));
    // Laplace's rule: the frequency as if there were one more frame of either kind.
    known
        .map(|[n, n_equal]| ((n_equal + 1.0) / (n + 2.0)).ln())
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use ndarray::Array2;
    use rand::Rng;

    #[test]
    fn a_taxel_that_freezes_is_found_and_hollow_objects_are_no_fault() {
        let mut rng = Seed::new(5).named("frozen").rng();
        // Discs and rings without noise, sorted by class.
        let labels: Vec<usize> = (0..200).map(|row| row / 100).collect();
        let mut frames = Array2::zeros((200, 144));
        for (mut frame, label) in frames.rows_mut().into_iter().zip(&labels) {
            let (y, x) = (rng.gen_range(5.0..7.0), rng.gen_range(5.0..7.0));
            for (taxel, reading) in frame.iter_mut().enumerate() {
                let away: f64 = ((taxel / 12) as f64 - y).hypot((taxel % 12) as f64 - x);
                let is_touched = away < 3.5 && (*label == 0 || away > 1.5);
                *reading = if is_touched {
                    1.0 - 0.2 * (away - 2.0).abs()
                } else {
                    0.0
                };
            }
        }
        let of = |frames: &Array2<f64>| {
            frozen_taxels(frames.view(), (12, 12), &labels, 0.1, &[true; 144], 0.01)
        };
        assert!(of(&frames).is_empty(), "{:?}", of(&frames));
        for row in 30..60 {
            frames[(row, 78)] = 0.31;
        }
        let found = of(&frames);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(
            (found[0].taxel, found[0].first, found[0].n_frames),
            (78, 30, 30)
        );
    }
}
