//! The scrambled block Hadamard ensemble \[SBHE\], by fast transforms.
//!
//! The map is Φ = Q W P. P permutes the taxels, W is block diagonal with Walsh–Hadamard matrices H/√B, Hᵢⱼ = (−1)^popcount(i & j), and
//! Q selects m coefficients in random order. If B does not divide n, zeros are added to complete the last block before the permutation, so
//! they are also scattered. Without them the rows of Φ are orthonormal.

use super::ensemble::{EnsembleAbout, Operator};
use super::subsample::permutation;
use crate::random::Seed;
use crate::world::ImageShape;
use ndarray::{ArrayView2, ArrayViewMut2};

/// Block size of the transform, a power of two: 32 as in \[SBHE\]. Larger blocks mix more taxels into each measurement and are slower; with 1 the ensemble is
/// a subsample. For arrays of fewer taxels, the block size is the next power of two above their number.
pub(crate) const BLOCK: usize = 32;
/// Number of frames transformed at a time, one per lane of a vector register.
const LANES: usize = 8;

/// Values of one taxel or one coefficient in several frames.
type Lanes = [f64; LANES];

/// Scrambled block Hadamard ensemble: a random permutation of the taxels, and a sorted selection of coefficients. Each required block is transformed once.
#[derive(Clone, Debug)]
pub(crate) struct ScrambledHadamard {
    n_taxels: usize,
    block: usize,
    /// Index of the taxel at each position before the transform; indices equal to or above the number of taxels denote added zeros.
    taxels: Vec<usize>,
    /// Pairs of indices, ascending: a coefficient of the Hadamard transform, and the measurement that uses this coefficient.
    picks: Vec<(usize, usize)>,
}

pub(crate) const ABOUT: EnsembleAbout = EnsembleAbout {
    ..EnsembleAbout::new("SBHE", |ImageShape { ny, nx }, m, seed| {
        Box::new(ScrambledHadamard::new(
            m,
            ny * nx,
            BLOCK,
            &seed.named("sbhe"),
        ))
    })
};

impl ScrambledHadamard {
    /// Draws the ensemble of m measurements of n taxels, with blocks of `block` taxels, a power of two.
    pub(crate) fn new(m: usize, n: usize, block: usize, stream: &Seed) -> Self {
        let block = block.min(n.next_power_of_two());
        let n_padded = n.next_multiple_of(block);
        let rows = permutation(n_padded, &stream.named("rows"));
        let mut picks: Vec<_> = rows.into_iter().take(m).zip(0..).collect();
        picks.sort_unstable();
        Self {
            n_taxels: n,
            block,
            taxels: permutation(n_padded, &stream.named("taxels")),
            picks,
        }
    }

    fn same_block(&self, a: &(usize, usize), b: &(usize, usize)) -> bool {
        a.0 / self.block == b.0 / self.block
    }

    /// Copies the values of the listed taxels from each frame to `values`; lanes without a frame stay zero.
    fn gather(&self, frames: &[f64], taxels: &[usize], values: &mut [Lanes]) {
        for (lane, frame) in frames.chunks_exact(self.n_taxels).enumerate() {
            for (value, &taxel) in values.iter_mut().zip(taxels) {
                value[lane] = frame.get(taxel).copied().unwrap_or(0.0);
            }
        }
    }
}

impl Operator for ScrambledHadamard {
    fn measure(&self, frames: ArrayView2<f64>, mut out: ArrayViewMut2<f64>) {
        let frames = frames.as_standard_layout();
        let all = frames.as_slice().unwrap_or_default();
        let scale = 1.0 / (self.block as f64).sqrt();
        let group_len = LANES * self.n_taxels;
        let mut values = vec![[0.0; LANES]; self.block];
        for (group, frames) in all.chunks(group_len).enumerate() {
            for picks in self.picks.chunk_by(|a, b| self.same_block(a, b)) {
                values.fill([0.0; LANES]);
                let first = picks[0].0 / self.block * self.block;
                self.gather(frames, &self.taxels[first..first + self.block], &mut values);
                transform(&mut values);
                for &(coefficient, measurement) in picks {
                    let lanes = &values[coefficient - first];
                    for (lane, value) in lanes[..frames.len() / self.n_taxels].iter().enumerate() {
                        out[[group * LANES + lane, measurement]] = scale * value;
                    }
                }
            }
        }
    }

    /// Calls `visit(measurement, taxel, value)` for each entry of the matrix that can be nonzero.
    fn each_entry(&self, visit: &mut dyn FnMut(usize, usize, f64)) {
        let scale = 1.0 / (self.block as f64).sqrt();
        for &(coefficient, measurement) in &self.picks {
            let (block, i) = (coefficient / self.block, coefficient % self.block);
            for (j, &taxel) in self.taxels[block * self.block..][..self.block]
                .iter()
                .enumerate()
            {
                if taxel < self.n_taxels {
                    let is_minus = (i & j).count_ones() % 2 == 1;
                    visit(measurement, taxel, if is_minus { -scale } else { scale });
                }
            }
        }
    }

    /// Returns the root mean square norm of the rows of Φ. The norm is below 1 if zeros were added to the taxels.
    fn row_norm(&self) -> f64 {
        let in_block = |coefficient: usize| {
            let first = coefficient / self.block * self.block;
            let taxels = &self.taxels[first..first + self.block];
            taxels
                .iter()
                .filter(|&&taxel| taxel < self.n_taxels)
                .count()
        };
        let n_entries: usize = self.picks.iter().map(|pick| in_block(pick.0)).sum();
        (n_entries as f64 / (self.block * self.picks.len()) as f64).sqrt()
    }
}

/// Applies the unscaled Walsh–Hadamard transform in natural order, in place, to the values of each lane, whose number is a power of two.
fn transform(values: &mut [Lanes]) {
    let mut half = 1;
    while half < values.len() {
        for pair in values.chunks_exact_mut(2 * half) {
            let (low, high) = pair.split_at_mut(half);
            for (a, b) in low.iter_mut().zip(high) {
                for lane in 0..LANES {
                    (a[lane], b[lane]) = (a[lane] + b[lane], a[lane] - b[lane]);
                }
            }
        }
        half *= 2;
    }
}
