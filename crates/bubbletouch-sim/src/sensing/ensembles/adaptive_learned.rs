//! Adaptive readout whose estimate of the frame uses statistics of training frames.
//!
//! The blocks are those of [`adaptive`](super::adaptive). Frames of training touches, with shifted copies, give the mean frame x₀, k principal components ψⱼ with
//! variances λⱼ, and a remainder of variance τ per taxel. A frame with the block means y = Bx has the estimate of least mean square error
//!
//! x̂ = x₀ + Σⱼ max(0, λⱼ − τ) aⱼ ψⱼ, a = Aᵀ (A Λ Aᵀ + τ BBᵀ)⁻¹ (y − Bx₀), with A = BΨ.
//!
//! τ estimates the variance of the noise, which training frames contain, too. B differs from frame to frame, so each frame solves its own system of at most m
//! equations. A row of A has the sums of all components over a rectangle, which are differences of four sums that are computed once.
//!
//! Pressure is never negative: negative values of an estimate are set to 0, unless the mean frame itself has negative values. A frame whose readings are all 0 is
//! untouched, and its estimate is 0.

use super::adaptive::{Adaptive, ReadBlock};
use super::dense::Dense;
use super::ensemble::{EnsembleAbout, Operator, TrainingFrames};
use crate::linalg::Cholesky;
use crate::random::Seed;
use crate::sensing::image_prior::{N_COMPONENTS, with_copies};
use crate::sensing::pca::Pca;
use crate::world::ImageShape;
use ndarray::{Array1, Array2, ArrayView1, ArrayView2, ArrayViewMut2, Axis, s};

/// Approximate number of training frames with shifted copies. With fewer frames, the components fit the training touches better than test touches; with more
/// frames, learning takes longer.
const N_FRAMES: usize = 8192;

/// Smallest noise variance relative to the mean variance of the readings. Without noise, the matrix to be inverted may be singular.
const LEAST_NOISE: f64 = 1e-12;

pub(crate) const ABOUT: EnsembleAbout = EnsembleAbout {
    is_adaptive: true,
    needs_rows: true,
    // The components and their sums.
    bytes: |_, n| 16.0 * n * n.min(N_COMPONENTS as f64),
    ..EnsembleAbout::learned(
        "adaptive blocks, learned estimate",
        |training, grid, m, seed| Ok(Box::new(AdaptiveLearned::new(training, grid, m, seed))),
    )
};

/// Adaptive readout with the statistics of training frames.
#[derive(Debug)]
struct AdaptiveLearned {
    readout: Adaptive,
    nx: usize,
    mean: Array1<f64>,
    /// Transposed components, a projection from k coefficients to n taxels.
    components: Dense,
    variance: Array1<f64>,
    /// Variance τ of the remainder, per taxel.
    rest: f64,
    /// Sums of the k components and of the mean frame over all taxels above and to the left of a corner. Shape ((ny + 1)(nx + 1), k + 1).
    sums: Array2<f64>,
    is_nonnegative: bool,
}

impl AdaptiveLearned {
    fn new(training: &TrainingFrames, grid: ImageShape, m: usize, seed: &Seed) -> Self {
        let seed = seed.named("adaptive_learned");
        let frames = with_copies(training.frames, grid, N_FRAMES, &seed);
        let n_frames = frames.nrows() as f64;
        let pca = Pca::new(frames, N_COMPONENTS.min(grid.n_values()), &seed);
        let rest = pca.rest();
        let accuracy = 3.0 * (rest / n_frames).sqrt();
        Self {
            readout: Adaptive::new(grid, m),
            nx: grid.nx,
            sums: corner_sums(pca.components.view(), pca.mean.view(), grid),
            is_nonnegative: pca.mean.iter().all(|value| *value >= -accuracy),
            components: Dense(pca.components.t().as_standard_layout().into_owned()),
            mean: pca.mean,
            variance: pca.variance,
            rest,
        }
    }

    /// Returns the coefficients of the components that estimate a frame, shape (k,).
    fn coefficients(&self, blocks: &[ReadBlock]) -> Array1<f64> {
        let k = self.variance.len();
        let mut sensed = Array2::zeros((blocks.len(), k + 1));
        for (mut row, ReadBlock { block, .. }) in sensed.outer_iter_mut().zip(blocks) {
            let (rows, columns) = (&block.rows, &block.columns);
            let area = block.area() as f64;
            for (y, x, sign) in [
                (rows.end, columns.end, 1.0),
                (rows.start, columns.end, -1.0),
                (rows.end, columns.start, -1.0),
                (rows.start, columns.start, 1.0),
            ] {
                row.scaled_add(sign / area, &self.sums.row(y * (self.nx + 1) + x));
            }
        }
        let (sensed, of_mean) = sensed.view().split_at(Axis(1), k);
        let readings = blocks
            .iter()
            .map(|read| read.sum / read.block.area() as f64);
        let difference = Array1::from_iter(readings) - of_mean.column(0);
        let weighted = &sensed * &self.variance;
        let mut covariance = weighted.dot(&sensed.t());
        let trace = covariance.diag().sum() / blocks.len() as f64;
        for (value, read) in covariance.diag_mut().iter_mut().zip(blocks) {
            *value += self.rest / read.block.area() as f64 + LEAST_NOISE * trace;
        }
        let Some(factor) = Cholesky::new(covariance) else {
            // Training frames do not differ.
            return Array1::zeros(k);
        };
        let solution = factor.solve(difference.view().insert_axis(Axis(1)));
        let signal = self
            .variance
            .mapv(|variance| (variance - self.rest).max(0.0));
        sensed.t().dot(&solution.column(0)) * signal
    }
}

impl Operator for AdaptiveLearned {
    fn measure(&self, frames: ArrayView2<f64>, mut out: ArrayViewMut2<f64>) {
        let mut coefficients = Array2::zeros((frames.nrows(), self.variance.len()));
        let mut is_touched = vec![false; frames.nrows()];
        for (number, frame) in frames.outer_iter().enumerate() {
            let blocks = self.readout.blocks(&frame.to_vec());
            is_touched[number] = blocks.iter().any(|read| read.sum != 0.0);
            coefficients
                .row_mut(number)
                .assign(&self.coefficients(&blocks));
        }
        self.components.measure(coefficients.view(), out.view_mut());
        for (mut row, is_touched) in out.outer_iter_mut().zip(is_touched) {
            match is_touched {
                true => row += &self.mean,
                false => row.fill(0.0),
            }
            if self.is_nonnegative {
                row.mapv_inplace(|value| value.max(0.0));
            }
        }
    }

    fn each_entry(&self, _: &mut dyn FnMut(usize, usize, f64)) {}
}

/// Returns the sums of k components (k × n) and of the mean frame over the taxels above and to the left of each corner of the array.
fn corner_sums(
    components: ArrayView2<f64>,
    mean: ArrayView1<f64>,
    ImageShape { ny, nx }: ImageShape,
) -> Array2<f64> {
    let k = components.nrows();
    let mut sums = Array2::zeros(((ny + 1) * (nx + 1), k + 1));
    for y in 0..ny {
        let mut line = Array1::<f64>::zeros(k + 1);
        for x in 0..nx {
            let taxel = y * nx + x;
            let (mut of_components, mut of_mean) = line.view_mut().split_at(Axis(0), k);
            of_components += &components.column(taxel);
            of_mean += mean[taxel];
            let above = &sums.row(y * (nx + 1) + x + 1) + &line;
            sums.slice_mut(s![(y + 1) * (nx + 1) + x + 1, ..])
                .assign(&above);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensing::image_estimate::tests::{GRID, bumps, error, noise};
    use crate::sensing::{Ensemble, Projection};

    fn learned(frames: &Array2<f64>, m: usize) -> Projection {
        let learned = (frames.view(), &Seed::new(1));
        Projection::learned(Ensemble::AdaptiveLearned, GRID, m, learned).unwrap()
    }

    #[test]
    fn the_learned_estimate_is_closer_than_block_means() {
        for (std, most) in [(0.0, 0.8), (0.2, 0.8)] {
            let training = bumps(600, "training") + noise(600, "training", std);
            let test = bumps(50, "test");
            let read = &test + &noise(50, "test", std);
            for m in [8, 16, 32] {
                let means = Projection::new(Ensemble::Adaptive, GRID, m, &Seed::new(1)).unwrap();
                let of_means = error(&means.measure(read.view()), &test);
                let estimate = learned(&training, m).measure(read.view());
                let found = error(&estimate, &test);
                assert!(found < most * of_means, "{std} {m}: {found} {of_means}");
                assert!(estimate.iter().all(|value| *value >= 0.0));
            }
        }
    }

    #[test]
    fn the_estimate_is_the_linear_one_of_its_blocks() {
        // Slow reference: block means as rows of a matrix, and one dense system per frame.
        let training = bumps(300, "training") + noise(300, "training", 0.1);
        let frames = bumps(9, "test") + noise(9, "test", 0.1);
        let frames = &frames;
        let learned_from = (training.view(), &Seed::new(1));
        let made = AdaptiveLearned::new(&learned_from.0.into(), GRID, 20, learned_from.1);
        let components = made.components.0.t();
        let mut expected = Array2::zeros((9, 144));
        for (frame, mut expected) in frames.outer_iter().zip(expected.outer_iter_mut()) {
            let blocks = made.readout.blocks(&frame.to_vec());
            let mut means = Array2::<f64>::zeros((blocks.len(), 144));
            for (mut row, read) in means.outer_iter_mut().zip(&blocks) {
                for taxel in read.block.lines(12).flatten() {
                    row[taxel] = 1.0 / read.block.area() as f64;
                }
            }
            let sensed = means.dot(&components.t());
            let mut covariance = (&sensed * &made.variance).dot(&sensed.t());
            covariance.scaled_add(made.rest, &means.dot(&means.t()));
            let difference = means.dot(&(&frame - &made.mean));
            let factor = Cholesky::new(covariance).unwrap();
            let solution = factor.solve(difference.view().insert_axis(Axis(1)));
            let signal = made.variance.mapv(|v| (v - made.rest).max(0.0));
            let coefficients = sensed.t().dot(&solution.column(0)) * signal;
            let estimate = coefficients.dot(&components) + &made.mean;
            expected.assign(&estimate.mapv(|value| value.max(0.0)));
        }
        let found = learned(&training, 20).measure(frames.view());
        assert!(error(&found, &expected) < 1e-9);
        let alone = learned(&training, 20);
        let together = alone.measure(frames.view());
        let one = alone.measure(frames.slice(s![7..8, ..]));
        assert_eq!(one.row(0), together.row(7), "equal bits in any batch");
    }

    #[test]
    fn an_untouched_frame_stays_zero_and_equal_frames_can_be_learned_from() {
        let test = bumps(600, "training");
        let zeros = Array2::zeros((2, 144));
        assert_eq!(learned(&test, 16).measure(zeros.view()), zeros);
        let same = Array2::from_elem((3, 144), 2.0);
        let drawn = Projection::new(Ensemble::AdaptiveLearned, GRID, 4, &Seed::new(1));
        assert!(drawn.unwrap_err().to_string().contains("learned"));
        let estimate = learned(&same, 4).measure(same.view());
        assert!(estimate.iter().all(|value| value.is_finite()));
    }
}
