//! Estimates of images of a skin from compressed measurements.
//!
//! Frames of training touches give statistics of images: their mean x₀, k principal components ψⱼ with mean squares λⱼ, and a remainder of mean square τ per
//! taxel. The linear estimate of least mean square error is α̂ = Λ Aᵀ (A Λ Aᵀ + τ ΦΦᵀ)⁻¹ (y − Φx₀), with A = ΦΨ.
//!
//! Training frames contain the noise of the signal, and so does λⱼ: readings of the untouched skin have a mean square νⱼ along ψⱼ. The estimate of
//! the image without noise reduces each coefficient (Wiener): x̂ = x₀ + Σ max(0, 1 − νⱼ / λⱼ) α̂ⱼ ψⱼ.
//!
//! Pressure is never negative, but the linear estimate has negative oscillations around a contact. Starting from x̂, two steps alternate. Negative values are
//! set to 0, and the nearest image with the measurements y is computed:
//!
//! x ← x₊ + Φ⁺ (y − Φx₊), Φ⁺ = Φᵀ (ΦΦᵀ)⁻¹.
//!
//! These steps are projections onto two convex sets that contain the image, so no step increases the distance between x and the image. Youla and Webb (1982),
//! *Image restoration by the method of convex projections*, IEEE Transactions on Medical Imaging 1, 81. The steps would also fit noise in the measurements, so
//! they are omitted if there is noise. The steps are also omitted if rows of Φ are linearly dependent.
//!
//! The estimate of a complete frame is the frame itself.

use super::image_prior::ImagePrior;
use super::{Lmmse, Projection, SensedDictionary};
use crate::error::Result;
use crate::linalg::Cholesky;
use ndarray::{Array2, ArrayView2};

/// Estimator of images (frames) from compressed measurements, prepared for any number of frames.
#[derive(Clone, Debug)]
pub struct ImageEstimate {
    /// Linear estimator of frames, with the projection; `None` if the measurements are complete frames.
    lmmse: Option<(Lmmse, Projection)>,
    /// Transposed pseudoinverse of the projection matrix, shape (n_measurements, n_taxels); `None` if the image may contain negative values.
    nearest: Option<Array2<f64>>,
    noise_std: f64,
}

/// Number of iterations that make the image nonnegative. With fewer iterations, larger oscillations remain. Each iteration costs one linear estimate and one
/// measurement of the image.
pub const N_STEPS: usize = 20;

impl ImageEstimate {
    /// Creates the estimator for complete frames; the noise level is computed from readings of the untouched skin.
    pub fn of_frames(untouched: ArrayView2<f64>) -> Self {
        Self {
            lmmse: None,
            nearest: None,
            noise_std: root_mean_square(untouched),
        }
    }

    /// Prepares the estimator for the measurements of a projection.
    ///
    /// # Errors
    /// If all training readings, or all entries of the projection, are zero.
    pub fn new(projection: &Projection, prior: &ImagePrior) -> Result<Self> {
        let sensed = SensedDictionary::new(projection, &prior.dictionary)?;
        let lmmse = Lmmse::shrunk(&sensed, 0.0, Some(&prior.shrinkage))?;
        let of_noise = lmmse.linear(projection.measure(prior.untouched.view()).view());
        let noise_std = root_mean_square(of_noise.view());
        let nearest = (noise_std == 0.0).then(|| Cholesky::new(projection.row_gram()));
        Ok(Self {
            noise_std,
            nearest: nearest
                .flatten()
                .map(|gram| gram.solve(projection.matrix().view())),
            lmmse: Some((lmmse, projection.clone())),
        })
    }

    /// Returns the noise standard deviation of an image per taxel, computed from readings of the untouched skin, in the unit of the images.
    pub fn noise_std(&self) -> f64 {
        self.noise_std
    }

    /// Estimates images, shape (n_frames, n_taxels), from measurements, shape (n_frames, n_measurements).
    ///
    /// # Panics
    /// If a row does not have m values.
    pub fn images(&self, measurements: ArrayView2<f64>) -> Array2<f64> {
        let Some((lmmse, projection)) = &self.lmmse else {
            return measurements.to_owned();
        };
        let mut images = lmmse.estimate(measurements);
        images.mapv_inplace(|value| value.max(0.0));
        let Some(nearest) = &self.nearest else {
            return images;
        };
        for _ in 0..N_STEPS {
            let unexplained = &measurements - &projection.measure(images.view());
            images += &unexplained.dot(nearest);
            images.mapv_inplace(|value| value.max(0.0));
        }
        images
    }
}

fn root_mean_square(values: ArrayView2<f64>) -> f64 {
    let squares: f64 = values.iter().map(|value| value * value).sum();
    (squares / values.len().max(1) as f64).sqrt()
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::Readings;
    use super::*;
    use crate::random::Seed;
    use crate::sensing::Ensemble;
    use crate::world::ImageShape;
    use rand::Rng;
    use rand_distr::StandardNormal;

    pub(in crate::sensing) const GRID: ImageShape = ImageShape { ny: 12, nx: 12 };

    /// Returns test frames of n taxels that contain bumps at random positions.
    pub(in crate::sensing) fn bumps(n: usize, name: &str) -> Array2<f64> {
        let mut rng = Seed::new(3).named(name).rng();
        let mut frames = Array2::zeros((n, 144));
        for mut frame in frames.outer_iter_mut() {
            let (x, y) = (rng.gen_range(3.0..9.0), rng.gen_range(3.0..9.0));
            for (taxel, value) in frame.iter_mut().enumerate() {
                let (dx, dy) = ((taxel % 12) as f64 - x, (taxel / 12) as f64 - y);
                *value = (1.0 - (dx * dx + dy * dy) / 9.0_f64).max(0.0);
            }
        }
        frames
    }

    pub(in crate::sensing) fn noise(n: usize, name: &str, std: f64) -> Array2<f64> {
        let mut rng = Seed::new(4).named(name).rng();
        Array2::from_shape_fn((n, 144), |_| std * rng.sample::<f64, _>(StandardNormal))
    }

    pub(in crate::sensing) fn error(a: &Array2<f64>, b: &Array2<f64>) -> f64 {
        (a - b).mapv(|d| d * d).mean().unwrap_or(0.0).sqrt()
    }

    fn estimate(ensemble: Ensemble, m: usize, std: f64) -> (ImageEstimate, Projection) {
        let projection = Projection::new(ensemble, GRID, m, &Seed::new(1)).unwrap();
        let (training, untouched) = (
            bumps(600, "training") + noise(600, "training", std),
            noise(200, "untouched", std),
        );
        let readings = Readings {
            training: training.view(),
            untouched: untouched.view(),
        };
        (estimated(&projection, readings, 600), projection)
    }

    pub(in crate::sensing) fn estimated(
        projection: &Projection,
        readings: Readings,
        n_frames: usize,
    ) -> ImageEstimate {
        if projection.ensemble() == Some(Ensemble::Identity) {
            return ImageEstimate::of_frames(readings.untouched);
        }
        let prior = ImagePrior::learned(GRID, readings, n_frames, &Seed::new(2)).unwrap();
        ImageEstimate::new(projection, &prior).unwrap()
    }

    #[test]
    fn more_measurements_say_more_of_the_image_and_all_of_them_everything() {
        let test = bumps(50, "test");
        let errors = [8, 24, 72, 144].map(|m| {
            let (estimate, projection) = estimate(Ensemble::Gaussian, m, 0.0);
            error(
                &estimate.images(projection.measure(test.view()).view()),
                &test,
            )
        });
        assert!(errors.is_sorted_by(|a, b| a > b), "{errors:?}");
        assert!(errors[3] < 1e-4, "{errors:?}");
        let (whole, projection) = estimate(Ensemble::Identity, 144, 0.0);
        assert_eq!(whole.images(projection.measure(test.view()).view()), test);
        assert_eq!(whole.noise_std(), 0.0);
    }

    #[test]
    fn an_image_without_negative_pressure_is_closer_than_the_linear_estimate() {
        let test = bumps(50, "test");
        for ensemble in [
            Ensemble::Gaussian,
            Ensemble::BlockAverage,
            Ensemble::Sbhe,
            Ensemble::Fourier,
        ] {
            let (estimate, projection) = estimate(ensemble, 16, 0.0);
            let measured = projection.measure(test.view());
            let (lmmse, _) = estimate.lmmse.as_ref().unwrap();
            let linear = lmmse.estimate(measured.view()).mapv(|value| value.max(0.0));
            let found = estimate.images(measured.view());
            assert!(found.iter().all(|&value| value >= 0.0));
            let (before, after) = (error(&linear, &test), error(&found, &test));
            assert!(after < before, "{ensemble:?}: {before} {after}");
        }
    }

    #[test]
    fn noise_is_known_and_an_estimate_is_closer_than_what_was_read() {
        let std = 0.2;
        let test = bumps(50, "test");
        let read = &test + &noise(50, "test", std);
        let (whole, _) = estimate(Ensemble::Identity, 144, std);
        assert!((whole.noise_std() / std - 1.0).abs() < 0.02);
        let (estimate, projection) = estimate(Ensemble::Gaussian, 144, std);
        let found = estimate.images(projection.measure(read.view()).view());
        assert!(error(&found, &test) < 0.6 * error(&read, &test));
        assert!(estimate.noise_std() < 0.6 * std);
    }
}
