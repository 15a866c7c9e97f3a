//! Very sparse random projection: few taxels a measurement, stored as their indices.
//!
//! Achlioptas (2003) showed that entries +√s, 0, −√s with probabilities 1/2s, 1 − 1/s, 1/2s preserve distances for s = 3, and
//! Li, Hastie and Church (2006, *Very sparse random projections*) for s up to √n where the data's tails are not heavy. A
//! measurement then adds and subtracts √n taxels on average instead of n.

use crate::random::Seed;
use ndarray::{ArrayView2, ArrayViewMut2};
use rand::Rng;

/// Frames measured side by side, one in each lane of a vector register.
const LANES: usize = 8;

/// Φ with entries ±√(s/n) at a density of 1/s, s = √n.
#[derive(Clone, Debug)]
pub(super) struct VerySparse {
    n_taxels: usize,
    /// √(s/n), which makes the mean square of an entry 1/n.
    scale: f64,
    rows: Vec<Row>,
}

/// The taxels that one measurement adds, and those that it subtracts, ascending.
#[derive(Clone, Debug, Default)]
struct Row {
    plus: Vec<usize>,
    minus: Vec<usize>,
}

impl VerySparse {
    /// Row r comes from the stream's child r alone, so a larger m keeps the smaller's rows.
    pub(super) fn new(m: usize, n: usize, stream: &Seed) -> Self {
        let s = (n as f64).sqrt();
        let rows = (0..m as u64).map(|row| Row::draw(n, 1.0 / s, &stream.numbered(row)));
        Self {
            n_taxels: n,
            scale: (s / n as f64).sqrt(),
            rows: rows.collect(),
        }
    }

    pub(super) fn row_norm(&self) -> f64 {
        let n_entries: usize = self
            .rows
            .iter()
            .map(|row| row.plus.len() + row.minus.len())
            .sum();
        self.scale * (n_entries as f64 / self.rows.len() as f64).sqrt()
    }

    /// Measurement, taxel and value of each entry that is not zero.
    pub(super) fn each_entry(&self, mut visit: impl FnMut(usize, usize, f64)) {
        for (measurement, row) in self.rows.iter().enumerate() {
            let plus = row.plus.iter().map(|&taxel| (taxel, self.scale));
            let minus = row.minus.iter().map(|&taxel| (taxel, -self.scale));
            plus.chain(minus)
                .for_each(|(taxel, value)| visit(measurement, taxel, value));
        }
    }

    pub(super) fn measure(&self, frames: ArrayView2<f64>, mut out: ArrayViewMut2<f64>) {
        let mut values = vec![[0.0; LANES]; self.n_taxels];
        let groups = frames.axis_chunks_iter(ndarray::Axis(0), LANES);
        for (group, frames) in groups.enumerate() {
            for (lane, frame) in frames.outer_iter().enumerate() {
                for (value, &x) in values.iter_mut().zip(frame) {
                    value[lane] = x;
                }
            }
            for (measurement, row) in self.rows.iter().enumerate() {
                let sums = row.sums(&values);
                for (lane, sum) in sums[..frames.nrows()].iter().enumerate() {
                    out[[group * LANES + lane, measurement]] = self.scale * sum;
                }
            }
        }
    }
}

impl Row {
    fn draw(n: usize, density: f64, stream: &Seed) -> Self {
        let mut rng = stream.rng();
        let mut row = Self::default();
        for taxel in 0..n {
            let u: f64 = rng.r#gen();
            if u < 0.5 * density {
                row.plus.push(taxel);
            } else if u < density {
                row.minus.push(taxel);
            }
        }
        row
    }

    /// The row's signed sum of each lane.
    fn sums(&self, values: &[[f64; LANES]]) -> [f64; LANES] {
        let mut sums = [0.0; LANES];
        for &taxel in &self.plus {
            for (sum, x) in sums.iter_mut().zip(values[taxel]) {
                *sum += x;
            }
        }
        for &taxel in &self.minus {
            for (sum, x) in sums.iter_mut().zip(values[taxel]) {
                *sum -= x;
            }
        }
        sums
    }
}
