//! Prepared measurement projection of any ensemble.

use super::Ensemble;
use super::ensembles::ScrambledHadamard;
use super::ensembles::{Operator, Source, TrainingFrames};
use crate::error::{Error, Result};
use crate::random::Seed;
use crate::world::ImageShape;
use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis, s};
use std::sync::Arc;

/// Map from a frame of n taxels to its measurements, prepared once and applied to any number of frames. The map is linear, y = Φx with m measurements, unless
/// the ensemble is adaptive.
///
/// ```
/// use bubbletouch_sim::random::Seed;
/// use bubbletouch_sim::sensing::{Ensemble, Projection};
/// use bubbletouch_sim::world::ImageShape;
/// use ndarray::Array2;
///
/// let frames = Array2::ones((3, 64));
/// let seed = Seed::new(2018).named("projection");
/// let projection = Projection::new(Ensemble::Sbhe, ImageShape { ny: 8, nx: 8 }, 16, &seed)?;
/// assert_eq!(projection.measure(frames.view()).dim(), (3, 16));
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Projection {
    pub(super) ensemble: Option<Ensemble>,
    pub(super) n_taxels: usize,
    pub(super) n_measurements: usize,
    pub(super) operator: Arc<dyn Operator>,
}

impl Projection {
    /// Draws the projection of an ny × nx array to m measurements, or prepares an adaptive readout with m readings per frame. Random numbers come from
    /// separate streams of `seed`.
    ///
    /// The identity ensemble and adaptive ensembles give one value per taxel for any m.
    ///
    /// # Errors
    /// If the array has no taxels, if m = 0 or m > n, or if the ensemble is learned.
    pub fn new(ensemble: Ensemble, grid: ImageShape, m: usize, seed: &Seed) -> Result<Self> {
        check_size(grid, m)?;
        match ensemble.about().source {
            Source::Drawn(draw) => Ok(Self::of(ensemble, grid, m, draw(grid, m, seed))),
            Source::Learned(_) => {
                let given = format!("{}, which are learned from touches", ensemble.about().words);
                Err(Error::input("ensemble", given, "an ensemble that is drawn"))
            }
        }
    }

    fn of(ensemble: Ensemble, grid: ImageShape, m: usize, operator: Box<dyn Operator>) -> Self {
        Self {
            ensemble: Some(ensemble),
            n_taxels: grid.n_values(),
            n_measurements: ensemble.n_measurements(m, grid.n_values()),
            operator: operator.into(),
        }
    }

    /// Prepares the projection of any ensemble. Learned ensembles use the frames of training touches (n_frames × n_taxels) with their labels.
    ///
    /// # Errors
    /// If the array has no taxels, m = 0, m > n, the frames differ in fewer than m directions or taxels, or required labels are missing.
    ///
    /// # Panics
    /// If a frame does not have n values.
    pub fn learned<'a>(
        ensemble: Ensemble,
        grid: ImageShape,
        m: usize,
        (training, seed): (impl Into<TrainingFrames<'a>>, &Seed),
    ) -> Result<Self> {
        let Source::Learned(learn) = ensemble.about().source else {
            return Self::new(ensemble, grid, m, seed);
        };
        let n = check_size(grid, m)?;
        let training = training.into();
        assert_eq!(training.frames.ncols(), n, "taxels in a frame");
        let operator = learn(&training, grid, m, seed)?;
        Ok(Self::of(ensemble, grid, m, operator))
    }

    /// Prepares the scrambled block Hadamard ensemble with blocks of `block` taxels. Block size 32 is used in \[SBHE\] and by the constructor `new`.
    ///
    /// A projection with m measurements uses at most m · `block` taxels. If this product is far below the number of taxels n, as on a body with millions of
    /// taxels, most taxels are never used. A block of about n / m taxels or more uses every taxel, with few entries per taxel.
    ///
    /// # Errors
    /// If the size is invalid, as for `new`, or if `block` is not a power of two.
    pub fn sbhe(grid: ImageShape, m: usize, block: usize, seed: &Seed) -> Result<Self> {
        let n = check_size(grid, m)?;
        if !block.is_power_of_two() {
            return Err(Error::input("Hadamard block", block, "a power of two"));
        }
        let hadamard = ScrambledHadamard::new(m, n, block, &seed.named("sbhe"));
        Ok(Self::of(Ensemble::Sbhe, grid, m, Box::new(hadamard)))
    }

    /// Creates the projection of an operator from outside of this crate. The operator maps frames of `n_taxels` values to `n_measurements` values.
    ///
    /// # Errors
    /// If there are no taxels, or not 1 to `n_taxels` measurements.
    pub fn from_operator(
        operator: impl Operator + 'static,
        n_taxels: usize,
        n_measurements: usize,
    ) -> Result<Self> {
        check_size(ImageShape::row(n_taxels), n_measurements)?;
        Ok(Self {
            ensemble: None,
            n_taxels,
            n_measurements,
            operator: Arc::new(operator),
        })
    }

    /// Returns the ensemble of the projection; `None` for [`from_operator`](Self::from_operator).
    pub fn ensemble(&self) -> Option<Ensemble> {
        self.ensemble
    }

    /// Returns the number of taxels in a frame.
    pub fn n_taxels(&self) -> usize {
        self.n_taxels
    }

    /// Returns the indices of the taxels that are read, in the order of the measurements, if each measurement is one taxel; otherwise `None`.
    pub fn taxels(&self) -> Option<&[usize]> {
        self.operator.taxels()
    }

    /// Returns the number of values of a measured frame: m, or one per taxel for the identity and for adaptive ensembles.
    pub fn n_measurements(&self) -> usize {
        self.n_measurements
    }

    /// Measures frames (n_frames × n, one per row); returns measurements, shape (n_frames, m).
    ///
    /// # Panics
    /// If a frame does not have n values.
    pub fn measure(&self, frames: ArrayView2<f64>) -> Array2<f64> {
        let mut measurements = Array2::zeros((frames.nrows(), self.n_measurements));
        self.measure_into(frames, measurements.view_mut());
        measurements
    }

    /// Measures frames (n_frames × n) and overwrites `measurements` (n_frames × m).
    ///
    /// # Panics
    /// If the shapes do not match.
    pub fn measure_into(&self, frames: ArrayView2<f64>, measurements: ArrayViewMut2<f64>) {
        assert_eq!(frames.ncols(), self.n_taxels, "taxels in a frame");
        let expected = (frames.nrows(), self.n_measurements);
        assert_eq!(measurements.dim(), expected, "frames × measurements");
        self.operator.measure(frames, measurements);
    }

    /// Calls `visit(measurement, taxel, value)` for each entry of the matrix Φ that can be nonzero, always in one order.
    pub(super) fn each_entry(&self, mut visit: impl FnMut(usize, usize, f64)) {
        self.operator.each_entry(&mut visit);
    }

    /// Divides each measurement that averages taxels by the sum of the weights of its present taxels, so that absent taxels, which read 0, do not lower the average.
    /// Other measurements are unchanged. `is_absent` has one value for each taxel; `measurements` has the shape (n_frames, m).
    pub fn average_present(&self, is_absent: &[bool], measurements: &mut Array2<f64>) {
        if !is_absent.contains(&true) {
            return;
        }
        // An average has weights of at least 0 with the sum 1.
        let mut sums = vec![(0.0, 0.0, true); self.n_measurements];
        self.each_entry(|measurement, taxel, value| {
            let (all, present, is_positive) = &mut sums[measurement];
            *all += value;
            *present += if is_absent[taxel % is_absent.len()] {
                0.0
            } else {
                value
            };
            *is_positive &= value >= 0.0;
        });
        for (mut column, (all, present, is_positive)) in
            measurements.columns_mut().into_iter().zip(sums)
        {
            if is_positive && (all - 1.0_f64).abs() < 1e-9 && present > 0.0 && present < all {
                column.mapv_inplace(|value| value / present);
            }
        }
    }

    /// Returns the root mean square norm of the rows of the matrix Φ. This norm equals the noise of measurements divided by the noise of taxels.
    pub fn row_norm(&self) -> f64 {
        self.operator.row_norm()
    }

    /// Returns ΦΦᵀ (m × m), the covariance matrix of measurements whose taxels have independent noise of variance 1.
    pub fn row_gram(&self) -> Array2<f64> {
        let of_matrix = |matrix: &Array2<f64>| matrix.dot(&matrix.t());
        self.operator.known_gram().unwrap_or_else(|| {
            let stored = self.operator.stored().map(of_matrix);
            stored.unwrap_or_else(|| of_matrix(&self.matrix()))
        })
    }

    /// Returns the matrix Φ (m × n) of the projection.
    pub fn matrix(&self) -> Array2<f64> {
        // Number of unit frames measured at a time, which bounds the memory.
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

/// Returns the number of taxels of the grid, or an error if the grid is empty or m is not from 1 to this number.
fn check_size(grid: ImageShape, m: usize) -> Result<usize> {
    let n = grid.n_values();
    if n == 0 || m == 0 || m > n {
        return Err(Error::input(
            "number of measurements",
            format!("{m} of {} × {} taxels", grid.nx, grid.ny),
            "from 1 to the number of taxels",
        ));
    }
    Ok(n)
}
