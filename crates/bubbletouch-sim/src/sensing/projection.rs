//! One prepared projection of any ensemble.

use super::Ensemble;
use super::ensembles::ScrambledHadamard;
use super::ensembles::{Operator, Source};
use crate::error::{Error, Result};
use crate::random::Seed;
use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis, s};
use std::sync::Arc;

/// A map y = Φx from frames of n taxels to m measurements, drawn once and applied to any number of frames.
///
/// ```
/// use bubbletouch_sim::random::Seed;
/// use bubbletouch_sim::sensing::{Ensemble, Projection};
/// use ndarray::Array2;
///
/// let frames = Array2::ones((3, 64));
/// let seed = Seed::new(2018).named("projection");
/// let projection = Projection::new(Ensemble::Sbhe, (8, 8), 16, &seed)?;
/// assert_eq!(projection.measure(frames.view()).dim(), (3, 16));
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Projection {
    ensemble: Ensemble,
    n_taxels: usize,
    n_measurements: usize,
    operator: Arc<dyn Operator>,
}

impl Projection {
    /// Draws the projection of an ny × nx array to m measurements from its own streams of `seed`.
    ///
    /// [`Ensemble::Identity`] has n measurements whatever m.
    ///
    /// # Errors
    /// An array without taxels; m = 0 or m > n; an ensemble that is learned.
    pub fn new(ensemble: Ensemble, grid: (usize, usize), m: usize, seed: &Seed) -> Result<Self> {
        let n = check_size(grid, m)?;
        let Source::Drawn(draw) = ensemble.about().source else {
            let given = format!("{}, which are learned from touches", ensemble.about().words);
            return Err(Error::input("ensemble", given, "an ensemble that is drawn"));
        };
        Ok(Self {
            ensemble,
            n_taxels: n,
            n_measurements: ensemble.n_measurements(m, n),
            operator: draw(grid, m, seed).into(),
        })
    }

    /// The same of any ensemble, beside frames that training touches read (n_frames × n): learned from them, where it is learned.
    ///
    /// # Errors
    /// An array without taxels; m = 0 or m > n; fewer than m directions in which frames differ.
    ///
    /// # Panics
    /// When a frame does not have n values.
    pub fn learned(
        ensemble: Ensemble,
        grid: (usize, usize),
        m: usize,
        (frames, seed): (ArrayView2<f64>, &Seed),
    ) -> Result<Self> {
        let Source::Learned(learn) = ensemble.about().source else {
            return Self::new(ensemble, grid, m, seed);
        };
        let n = check_size(grid, m)?;
        assert_eq!(frames.ncols(), n, "taxels in a frame");
        Ok(Self {
            ensemble,
            n_taxels: n,
            n_measurements: m,
            operator: learn(frames, m, seed)?.into(),
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
            operator: Arc::new(hadamard),
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
    pub fn measure_into(&self, frames: ArrayView2<f64>, measurements: ArrayViewMut2<f64>) {
        assert_eq!(frames.ncols(), self.n_taxels, "taxels in a frame");
        let expected = (frames.nrows(), self.n_measurements);
        assert_eq!(measurements.dim(), expected, "frames × measurements");
        self.operator.measure(frames, measurements);
    }

    /// Calls `visit` with measurement, taxel and value of each entry of Φ that may not be zero; the same order every time.
    pub(super) fn each_entry(&self, mut visit: impl FnMut(usize, usize, f64)) {
        self.operator.each_entry(&mut visit);
    }

    /// Root mean square norm of a row of Φ: how much louder noise on a taxel is in a measurement.
    pub fn row_norm(&self) -> f64 {
        self.operator.row_norm()
    }

    /// ΦΦᵀ, m × m: the covariance of measurements of independent noise of variance 1 on every taxel.
    pub fn row_gram(&self) -> Array2<f64> {
        let of_matrix = |matrix: &Array2<f64>| matrix.dot(&matrix.t());
        self.operator.known_gram().unwrap_or_else(|| {
            let stored = self.operator.stored().map(of_matrix);
            stored.unwrap_or_else(|| of_matrix(&self.matrix()))
        })
    }

    /// Φ itself, m × n: what [`measure`](Self::measure) applies.
    pub fn matrix(&self) -> Array2<f64> {
        // Unit frames are measured so many at a time, to bound their memory.
        const BLOCK: usize = 256;
        if let Some(matrix) = self.operator.stored() {
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
