//! Ensembles with a stored matrix Φ.

use super::ensemble::{Draw, EnsembleAbout, Operator};
use crate::random::Seed;
use ndarray::linalg::general_mat_mul;
use ndarray::{Array1, Array2, ArrayView2, ArrayViewMut2, s};
use rand_chacha::ChaCha8Rng;

/// Stored matrix Φ of a projection, shape (number of measurements, number of taxels).
#[derive(Debug)]
pub(crate) struct Dense(pub(crate) Array2<f64>);

impl Operator for Dense {
    /// Writes the measurements X Φᵀ of the frames X, computed by a blocked matrix product. Each measurement is summed over the taxels in one fixed order for any
    /// number of frames or measurements (tested as a law). Taxels that are zero in all frames are omitted, which does not change the bits of the result.
    fn measure(&self, frames: ArrayView2<f64>, mut out: ArrayViewMut2<f64>) {
        let touched = touched(frames);
        if touched.len() as f64 > MOSTLY_TOUCHED * frames.ncols() as f64 {
            return general_mat_mul(1.0, &frames, &self.0.t(), 0.0, &mut out);
        }
        out.fill(0.0);
        for taxels in touched.chunk_by(|a, b| a / SUMMED_TOGETHER == b / SUMMED_TOGETHER) {
            let (frames, matrix) = (columns(frames, taxels), columns(self.0.view(), taxels));
            general_mat_mul(1.0, &frames, &matrix.t(), 1.0, &mut out);
        }
    }

    fn each_entry(&self, visit: &mut dyn FnMut(usize, usize, f64)) {
        let entries = self.0.indexed_iter();
        entries.for_each(|((measurement, taxel), &value)| visit(measurement, taxel, value));
    }

    fn row_norm(&self) -> f64 {
        let square = self.0.iter().map(|v| v * v).sum::<f64>();
        (square / self.0.nrows() as f64).sqrt()
    }

    fn stored(&self) -> Option<&Array2<f64>> {
        Some(&self.0)
    }
}

/// Describes an ensemble with a stored matrix, which the function `draw` creates.
pub(crate) const fn about(words: &'static str, draw: Draw) -> EnsembleAbout {
    EnsembleAbout {
        // Memory during drawing and afterwards.
        bytes: |m, n| 16.0 * n * m,
        ..EnsembleAbout::new(words, draw)
    }
}

/// Returns a matrix of m rows of n random numbers of variance 1, divided by √n. Row r depends only on child r of the random stream, so a larger m keeps the
/// rows of a smaller m.
pub(crate) fn by_rows(
    m: usize,
    n: usize,
    stream: &Seed,
    row: impl Fn(&mut ChaCha8Rng) -> Array1<f64>,
) -> Array2<f64> {
    let scale = 1.0 / (n as f64).sqrt();
    let mut matrix: Array2<f64> = Array2::zeros((m, n));
    for (number, mut entries) in matrix.outer_iter_mut().enumerate() {
        let mut rng = stream.numbered(number as u64).rng();
        entries.assign(&row(&mut rng));
    }
    matrix * scale
}

/// Number of taxels that the matrix product sums in one block (`D_KC` of matrixmultiply). Omitting zeros within a block does not change the bits of the
/// result.
const SUMMED_TOGETHER: usize = 256;
/// Fraction of nonzero taxels above which the product uses all taxels. Above this fraction, copying the nonzero taxels would take longer than it saves.
const MOSTLY_TOUCHED: f64 = 0.8;

/// Returns the indices of taxels that are nonzero in at least one frame, ascending.
fn touched(frames: ArrayView2<f64>) -> Vec<usize> {
    let mut any = vec![false; frames.ncols()];
    for frame in frames.outer_iter() {
        let taxels = any.iter_mut().zip(frame);
        taxels.for_each(|(any, value)| *any |= *value != 0.0);
    }
    (0..any.len()).filter(|&taxel| any[taxel]).collect()
}

/// Returns the columns `picked` of a matrix, in this order, as a new matrix.
fn columns(matrix: ArrayView2<f64>, picked: &[usize]) -> Array2<f64> {
    let mut columns = Array2::zeros((matrix.nrows(), picked.len()));
    for (row, mut to) in matrix.outer_iter().zip(columns.outer_iter_mut()) {
        let mut start = 0;
        // Adjacent columns are copied together.
        for run in picked.chunk_by(|a, b| a + 1 == *b) {
            let end = start + run.len();
            let from = row.slice(s![run[0]..run[0] + run.len()]);
            to.slice_mut(s![start..end]).assign(&from);
            start = end;
        }
    }
    columns
}
