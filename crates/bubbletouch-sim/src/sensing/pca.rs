//! Principal components of frames, by a randomised range finder.
//!
//! Algorithm 4.4 (subspace iteration) of Halko, Martinsson and Tropp (2011), *Finding structure with randomness*, is followed by a Rayleigh–Ritz step. This
//! step diagonalises the frames in the computed subspace exactly. If the number of directions is at least the rank of the frames, the result equals the
//! full eigendecomposition.

use crate::linalg::{orthonormal_rows, symmetric_eigen};
use crate::random::Seed;
use ndarray::{Array1, Array2, ArrayViewMut1, Axis};
use ndarray_rand::RandomExt;
use rand_distr::StandardNormal;

/// Number of directions computed in addition to the requested components. If the number is smaller, the last components are inaccurate; if larger, only the
/// time increases.
const OVERSAMPLING: usize = 16;
/// Number of power iterations; each product with the covariance matrix squares the ratio of retained to discarded variances.
const ITERATIONS: usize = 3;
/// Smallest variance of a component relative to the largest variance; smaller variances are rounding errors.
const LEAST_VARIANCE: f64 = 1e-12;

/// Mean frame and principal components.
#[derive(Clone, Debug)]
pub(super) struct Pca {
    /// Mean of the training frames, shape (n_taxels,).
    pub mean: Array1<f64>,
    /// Orthonormal components, shape (n_components, n_taxels), in order of decreasing variance; the largest entry of each component is positive.
    pub components: Array2<f64>,
    /// Variance of the training frames along each component (divisor: number of frames).
    pub variance: Array1<f64>,
    /// Mean square distance of the frames from their mean, summed over all taxels.
    pub total_variance: f64,
}

impl Pca {
    /// Computes at most k principal components of frames (n_frames × n_taxels), or fewer if the rank of the frames is lower. The frames are centred in place.
    pub(super) fn new(mut frames: Array2<f64>, k: usize, seed: &Seed) -> Self {
        let (n_frames, n) = frames.dim();
        let mean = frames
            .mean_axis(Axis(0))
            .unwrap_or_else(|| Array1::zeros(n));
        frames -= &mean;
        let centred = frames;
        let n_directions = (k + OVERSAMPLING).min(n_frames).min(n);
        let mut rng = seed.named("pca").rng();
        let random = Array2::random_using((n_directions, n_frames), StandardNormal, &mut rng);
        let mut basis = orthonormal_rows(random.dot(&centred));
        drop(random);
        for _ in 0..ITERATIONS {
            let across = orthonormal_rows(basis.dot(&centred.t()));
            basis = orthonormal_rows(across.dot(&centred));
        }
        let scores = basis.dot(&centred.t());
        let covariance = scores.dot(&scores.t()) / n_frames.max(1) as f64;
        let (values, vectors) = symmetric_eigen(covariance.view());
        let largest = values.last().copied().unwrap_or(0.0);
        let kept: Vec<usize> = (0..values.len())
            .rev()
            .take(k)
            .take_while(|&i| values[i] > LEAST_VARIANCE * largest)
            .collect();
        let mut components = vectors.select(Axis(0), &kept).dot(&basis);
        components.outer_iter_mut().for_each(point_up);
        Self {
            mean,
            components,
            variance: values.select(Axis(0), &kept),
            total_variance: centred.iter().map(|x| x * x).sum::<f64>() / n_frames.max(1) as f64,
        }
    }
}

impl Pca {
    /// Returns the mean square, per taxel, of the part of the frames that the components cannot represent.
    pub(super) fn rest(&self) -> f64 {
        let rest = (self.total_variance - self.variance.sum()) / self.mean.len() as f64;
        rest.max(0.0)
    }
}

/// Flips a direction so that its largest entry is positive, because the sign of a component is arbitrary.
fn point_up(mut row: ArrayViewMut1<f64>) {
    let largest = row
        .iter()
        .fold(0.0f64, |a, &b| if b.abs() > a.abs() { b } else { a });
    if largest < 0.0 {
        row.mapv_inplace(|v| -v);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(n_frames: usize, n: usize) -> Array2<f64> {
        // The spectrum decreases, so neighbours are similar.
        Array2::from_shape_fn((n_frames, n), |(i, j)| {
            let x = j as f64 / n as f64;
            (1..8)
                .map(|k| ((i * k * k) as f64).sin() / k as f64 * (k as f64 * 3.0 * x).cos())
                .sum()
        })
    }

    #[test]
    fn components_are_those_of_the_full_eigendecomposition() {
        let frames = frames(50, 30);
        let pca = Pca::new(frames.clone(), 5, &Seed::new(1));
        let centred = &frames - &frames.mean_axis(Axis(0)).unwrap();
        let covariance = centred.t().dot(&centred) / 50.0;
        let (values, vectors) = symmetric_eigen(covariance.view());
        for k in 0..5 {
            let (value, vector) = (values[29 - k], vectors.row(29 - k));
            assert!((pca.variance[k] - value).abs() < 1e-10 * values[29]);
            let along = vector.dot(&pca.components.row(k)).abs();
            assert!((along - 1.0).abs() < 1e-8, "{k}: {along}");
        }
        assert!((pca.total_variance - values.sum()).abs() < 1e-10);
    }

    #[test]
    fn frames_that_span_few_directions_have_few_components() {
        let frames = frames(40, 25);
        let pca = Pca::new(frames, 25, &Seed::new(1));
        let unit = pca.components.dot(&pca.components.t());
        let error = unit - Array2::<f64>::eye(pca.components.nrows());
        assert!(error.iter().all(|e| e.abs() < 1e-12));
        assert!(pca.components.nrows() <= 7, "seven cosines");
        assert!((pca.variance.sum() / pca.total_variance - 1.0).abs() < 1e-10);
        let same = Array2::from_elem((3, 4), 2.0);
        assert_eq!(Pca::new(same, 2, &Seed::new(1)).components.nrows(), 0);
    }
}
