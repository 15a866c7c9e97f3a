//! One prepared projection of any ensemble.

use super::hadamard::{BLOCK, ScrambledHadamard};
use super::sparse::VerySparse;
use super::{Ensemble, block_average, dense, subsample};
use crate::error::{Error, Result};
use crate::random::Seed;
use block_average::Block;
use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis, s};

/// A map y = Φx from frames of n taxels to m measurements, drawn once and applied to any number of frames.
///
/// ```
/// use bubbletouch::random::Seed;
/// use bubbletouch::sensing::{Ensemble, Projection};
/// use ndarray::Array2;
///
/// let frames = Array2::ones((3, 64));
/// let seed = Seed::new(2018).named("projection");
/// let projection = Projection::new(Ensemble::Sbhe, (8, 8), 16, &seed)?;
/// assert_eq!(projection.measure(frames.view()).dim(), (3, 16));
/// # Ok::<(), bubbletouch::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Projection {
    ensemble: Ensemble,
    n_taxels: usize,
    n_measurements: usize,
    operator: Operator,
}

/// What each ensemble keeps.
#[derive(Clone, Debug)]
enum Operator {
    /// Φ, m × n.
    Dense(Array2<f64>),
    Sparse(VerySparse),
    Hadamard(ScrambledHadamard),
    Blocks(Vec<Block>),
    /// The taxel of each measurement.
    Taxels(Vec<usize>),
    Identity,
}

impl Projection {
    /// Draws the projection of an ny × nx array to m measurements from its own streams of `seed`.
    ///
    /// [`Ensemble::Identity`] has n measurements whatever m.
    ///
    /// # Errors
    /// An array without taxels; m = 0 or m > n.
    pub fn new(ensemble: Ensemble, grid: (usize, usize), m: usize, seed: &Seed) -> Result<Self> {
        let n = check_size(grid, m)?;
        let operator = match ensemble {
            Ensemble::Gaussian => Operator::Dense(dense::gaussian(m, n, &seed.named("gaussian"))),
            Ensemble::Bernoulli => {
                Operator::Dense(dense::bernoulli(m, n, &seed.named("bernoulli")))
            }
            Ensemble::Sparse => Operator::Sparse(VerySparse::new(m, n, &seed.named("sparse"))),
            Ensemble::Sbhe => {
                let stream = seed.named("sbhe");
                Operator::Hadamard(ScrambledHadamard::new(m, n, BLOCK, &stream))
            }
            Ensemble::BlockAverage => Operator::Blocks(block_average::blocks(grid, m)),
            Ensemble::Subsample => {
                Operator::Taxels(subsample::taxels(m, n, &seed.named("subsample")))
            }
            Ensemble::Identity => Operator::Identity,
        };
        let n_measurements = if ensemble == Ensemble::Identity { n } else { m };
        Ok(Self {
            ensemble,
            n_taxels: n,
            n_measurements,
            operator,
        })
    }

    /// The scrambled block Hadamard ensemble in blocks of `block` taxels, where \[SBHE\] and [`Projection::new`] have 32.
    ///
    /// m measurements read at most m · `block` taxels. Where that is far below n, as on a body of millions, most taxels are never
    /// read: a block of some n / m taxels or more lets every taxel be heard, and still costs few entries a taxel.
    ///
    /// # Errors
    /// As [`Projection::new`]; a block that is not a power of two.
    pub fn sbhe(grid: (usize, usize), m: usize, block: usize, seed: &Seed) -> Result<Self> {
        let n = check_size(grid, m)?;
        if !block.is_power_of_two() {
            return Err(Error::input("Hadamard block", block, "a power of two"));
        }
        let hadamard = ScrambledHadamard::new(m, n, block, &seed.named("sbhe"));
        Ok(Self {
            ensemble: Ensemble::Sbhe,
            n_taxels: n,
            n_measurements: m,
            operator: Operator::Hadamard(hadamard),
        })
    }

    /// The ensemble it was drawn from.
    pub fn ensemble(&self) -> Ensemble {
        self.ensemble
    }

    /// n, the length of a frame.
    pub fn n_taxels(&self) -> usize {
        self.n_taxels
    }

    /// m, the length of a row of measurements.
    pub fn n_measurements(&self) -> usize {
        self.n_measurements
    }

    /// Measures frames (n_frames × n, one a row): n_frames × m.
    ///
    /// # Panics
    /// When a frame does not have n values.
    pub fn measure(&self, frames: ArrayView2<f64>) -> Array2<f64> {
        let mut measurements = Array2::zeros((frames.nrows(), self.n_measurements));
        self.measure_into(frames, measurements.view_mut());
        measurements
    }

    /// Measures frames (n_frames × n) into `measurements` (n_frames × m), whatever was there.
    ///
    /// # Panics
    /// When a shape does not match.
    pub fn measure_into(&self, frames: ArrayView2<f64>, mut measurements: ArrayViewMut2<f64>) {
        assert_eq!(frames.ncols(), self.n_taxels, "taxels in a frame");
        let expected = (frames.nrows(), self.n_measurements);
        assert_eq!(measurements.dim(), expected, "frames × measurements");
        match &self.operator {
            Operator::Dense(matrix) => dense::measure(matrix, frames, measurements),
            Operator::Sparse(sparse) => sparse.measure(frames, measurements),
            Operator::Hadamard(hadamard) => hadamard.measure(frames, measurements),
            Operator::Blocks(blocks) => block_average::measure(blocks, frames, measurements),
            Operator::Taxels(taxels) => {
                for (frame, mut row) in frames.outer_iter().zip(measurements.outer_iter_mut()) {
                    row.iter_mut().zip(taxels).for_each(|(y, &i)| *y = frame[i]);
                }
            }
            Operator::Identity => measurements.assign(&frames),
        }
    }

    /// Calls `visit` with measurement, taxel and value of each entry of Φ that may not be zero; the same order every time.
    pub(super) fn each_entry(&self, mut visit: impl FnMut(usize, usize, f64)) {
        match &self.operator {
            Operator::Dense(matrix) => {
                let entries = matrix.indexed_iter();
                entries.for_each(|((measurement, taxel), &value)| visit(measurement, taxel, value));
            }
            Operator::Sparse(sparse) => sparse.each_entry(visit),
            Operator::Hadamard(hadamard) => hadamard.each_entry(visit),
            Operator::Blocks(blocks) => block_average::each_entry(blocks, visit),
            Operator::Taxels(taxels) => {
                let picked = taxels.iter().enumerate();
                picked.for_each(|(measurement, &taxel)| visit(measurement, taxel, 1.0));
            }
            Operator::Identity => (0..self.n_taxels).for_each(|taxel| visit(taxel, taxel, 1.0)),
        }
    }

    /// Root mean square norm of a row of Φ: how much louder noise on a taxel is in a measurement.
    pub fn row_norm(&self) -> f64 {
        match &self.operator {
            Operator::Dense(matrix) => {
                let square = matrix.iter().map(|v| v * v).sum::<f64>();
                (square / self.n_measurements as f64).sqrt()
            }
            Operator::Sparse(sparse) => sparse.row_norm(),
            Operator::Hadamard(hadamard) => hadamard.row_norm(),
            Operator::Blocks(blocks) => block_average::row_squares(blocks)
                .mean()
                .unwrap_or(1.0)
                .sqrt(),
            Operator::Taxels(_) | Operator::Identity => 1.0,
        }
    }

    /// ΦΦᵀ, m × m: the covariance of measurements of independent noise of variance 1 on every taxel.
    pub fn row_gram(&self) -> Array2<f64> {
        match &self.operator {
            Operator::Taxels(_) | Operator::Identity => Array2::eye(self.n_measurements),
            Operator::Blocks(blocks) => Array2::from_diag(&block_average::row_squares(blocks)),
            Operator::Dense(matrix) => matrix.dot(&matrix.t()),
            Operator::Sparse(_) | Operator::Hadamard(_) => {
                let matrix = self.matrix();
                matrix.dot(&matrix.t())
            }
        }
    }

    /// Φ itself, m × n: what [`measure`](Self::measure) applies.
    pub fn matrix(&self) -> Array2<f64> {
        // Unit frames are measured so many at a time, to bound their memory.
        const BLOCK: usize = 256;
        if let Operator::Dense(matrix) = &self.operator {
            return matrix.clone();
        }
        let mut matrix = Array2::zeros((self.n_measurements, self.n_taxels));
        for (block, mut columns) in matrix.axis_chunks_iter_mut(Axis(1), BLOCK).enumerate() {
            let mut frames = Array2::zeros((columns.ncols(), self.n_taxels));
            let mut units = frames.slice_mut(s![.., block * BLOCK..]);
            units.diag_mut().fill(1.0);
            columns.assign(&self.measure(frames.view()).t());
        }
        matrix
    }
}

/// The taxels of a grid that has any, and from which m measurements can be made.
fn check_size(grid: (usize, usize), m: usize) -> Result<usize> {
    let n = grid.0 * grid.1;
    if n == 0 || m == 0 || m > n {
        return Err(Error::input(
            "number of measurements",
            format!("{m} of {} × {} taxels", grid.1, grid.0),
            "from 1 to the number of taxels",
        ));
    }
    Ok(n)
}
