//! Very sparse random projection: few taxels per measurement, stored as indices.
//!
//! Achlioptas (2003) showed that entries +√s, 0, −√s with probabilities 1/2s, 1 − 1/s, 1/2s preserve distances for s = 3. Li,
//! Hastie and Church (2006, *Very sparse random projections*) showed this for s up to √n if the data are not heavy-tailed. A
//! measurement then adds and subtracts √n taxels on average instead of n.

use super::ensemble::{EnsembleAbout, Operator};
use crate::random::Seed;
use crate::world::ImageShape;
use ndarray::{ArrayView2, ArrayViewMut2};
use rand::Rng;

/// Number of frames measured at a time, one per lane of a vector register.
const LANES: usize = 8;
/// Minimum number of taxels for which only the nonzero matrix entries are drawn. Drawing every entry takes a minute on a body with millions of taxels.
/// Smaller arrays draw every entry for compatibility with earlier results.
const BY_GAPS_FROM: usize = 1 << 17;

/// Matrix Φ for n taxels with nonzero entries ±√(s/n) at a density of 1/s, s = √n.
#[derive(Clone, Debug)]
pub(crate) struct VerySparse {
    n_taxels: usize,
    /// Magnitude √(s/n) of the nonzero entries, s = √n for n taxels, so that the mean square of all entries is 1/n.
    scale: f64,
    rows: Vec<Row>,
}

/// Indices of the taxels that one measurement adds, and of the taxels that it subtracts, ascending.
#[derive(Clone, Debug, Default)]
struct Row {
    plus: Vec<usize>,
    minus: Vec<usize>,
}

pub(crate) const ABOUT: EnsembleAbout = EnsembleAbout {
    // m rows with √n entries each.
    bytes: |m, n| 16.0 * n.sqrt() * m,
    ..EnsembleAbout::new("sparse", |ImageShape { ny, nx }, m, seed| {
        Box::new(VerySparse::new(m, ny * nx, &seed.named("sparse")))
    })
};

impl VerySparse {
    /// Draws a matrix of m rows for n taxels. Row r depends only on child r of the random stream, so a larger m keeps the rows of a smaller m.
    pub(crate) fn new(m: usize, n: usize, stream: &Seed) -> Self {
        let s = (n as f64).sqrt();
        let rows = (0..m as u64).map(|row| Row::draw(n, 1.0 / s, &stream.numbered(row)));
        Self {
            n_taxels: n,
            scale: (s / n as f64).sqrt(),
            rows: rows.collect(),
        }
    }
}

impl Operator for VerySparse {
    fn row_norm(&self) -> f64 {
        let n_entries: usize = self
            .rows
            .iter()
            .map(|row| row.plus.len() + row.minus.len())
            .sum();
        self.scale * (n_entries as f64 / self.rows.len() as f64).sqrt()
    }

    /// Calls `visit(measurement, taxel, value)` for each nonzero matrix entry.
    fn each_entry(&self, visit: &mut dyn FnMut(usize, usize, f64)) {
        for (measurement, row) in self.rows.iter().enumerate() {
            let plus = row.plus.iter().map(|&taxel| (taxel, self.scale));
            let minus = row.minus.iter().map(|&taxel| (taxel, -self.scale));
            plus.chain(minus)
                .for_each(|(taxel, value)| visit(measurement, taxel, value));
        }
    }

    fn measure(&self, frames: ArrayView2<f64>, mut out: ArrayViewMut2<f64>) {
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
        match n < BY_GAPS_FROM {
            true => Self::draw_each(n, density, stream),
            false => Self::draw_by_gaps(n, density, stream),
        }
    }

    /// Draws the matrix row of one measurement: each taxel is added or subtracted with probability `density` / 2 each, otherwise ignored.
    fn draw_each(n: usize, density: f64, stream: &Seed) -> Self {
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

    /// Draws the matrix row of one measurement with the distribution of `draw_each`, but only its nonzero entries. The number of zeros before the next entry
    /// is geometric: it is at least g with probability (1 − density)^g.
    fn draw_by_gaps(n: usize, density: f64, stream: &Seed) -> Self {
        let mut rng = stream.rng();
        let log_zero = (-density).ln_1p();
        let mut row = Self::default();
        let mut next = 0;
        loop {
            let above_zero = 1.0 - rng.r#gen::<f64>();
            let zeros = above_zero.ln() / log_zero;
            if zeros >= (n - next) as f64 {
                return row;
            }
            let taxel = next + zeros as usize;
            match rng.r#gen() {
                true => row.plus.push(taxel),
                false => row.minus.push(taxel),
            }
            next = taxel + 1;
        }
    }

    /// Returns, for each lane, the sum of the added taxels minus the sum of the subtracted taxels.
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

#[cfg(test)]
mod tests {
    use super::*;

    const N: usize = 20_000;
    const ROWS: u64 = 400;

    /// Returns statistics of many drawn rows. The first array contains the mean and variance of the entries per row, the fraction of positive entries, and the
    /// number of adjacent pairs. The second array contains the number of entries in each tenth of the taxels.
    fn counts(draw: fn(usize, f64, &Seed) -> Row) -> ([f64; 4], [f64; 10]) {
        let density = 1.0 / (N as f64).sqrt();
        let (mut sizes, mut n_plus, mut n_pairs, mut tenths) = (Vec::new(), 0, 0, [0.0; 10]);
        for number in 0..ROWS {
            let row = draw(N, density, &Seed::new(7).numbered(number));
            for half in [&row.plus, &row.minus] {
                assert!(half.windows(2).all(|pair| pair[0] < pair[1]), "ascending");
            }
            let mut all = [row.plus.clone(), row.minus].concat();
            all.sort_unstable();
            assert!(all.iter().all(|&taxel| taxel < N));
            assert!(all.windows(2).all(|pair| pair[0] < pair[1]), "each once");
            n_pairs += all.windows(2).filter(|pair| pair[1] == pair[0] + 1).count();
            all.iter().for_each(|&taxel| tenths[taxel * 10 / N] += 1.0);
            n_plus += row.plus.len();
            sizes.push(all.len() as f64);
        }
        let total: f64 = sizes.iter().sum();
        let mean = total / ROWS as f64;
        let variance = sizes.iter().map(|size| (size - mean).powi(2)).sum::<f64>() / ROWS as f64;
        (
            [mean, variance, n_plus as f64 / total, n_pairs as f64],
            tenths,
        )
    }

    #[test]
    fn rows_drawn_by_gaps_obey_the_law_of_rows_drawn_entry_by_entry() {
        let root = (N as f64).sqrt();
        for draw in [Row::draw_each, Row::draw_by_gaps] {
            let ([mean, variance, plus, pairs], tenths) = counts(draw);
            // Five standard errors of the binomial distribution with n = N and p = 1/√N.
            let spread = (root / ROWS as f64).sqrt();
            assert!((mean - root).abs() < 5.0 * spread, "{mean} of {root}");
            assert!((variance / root - 1.0).abs() < 5.0 * (2.0 / ROWS as f64).sqrt());
            assert!((plus - 0.5).abs() < 5.0 * 0.5 / (root * ROWS as f64).sqrt());
            // Two adjacent taxels are both entries with probability p² = 1/N; a row has about N such pairs.
            assert!(
                (pairs - ROWS as f64).abs() < 5.0 * (ROWS as f64).sqrt(),
                "{pairs}"
            );
            let tenth = 0.1 * root * ROWS as f64;
            assert!(
                tenths
                    .iter()
                    .all(|n| (n - tenth).abs() < 5.0 * tenth.sqrt())
            );
        }
    }
}
