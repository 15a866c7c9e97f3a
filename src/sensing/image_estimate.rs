//! Images of what a skin reads, from compressed measurements of it.
//!
//! Frames that training touches read say what images are like: their mean x₀, k principal components ψⱼ with mean squares λⱼ, and a rest of
//! mean square τ a taxel. The [linear estimate](super::Lmmse) of least mean square error is α̂ = Λ Aᵀ (A Λ Aᵀ + τ ΦΦᵀ)⁻¹ (y − Φx₀), A = ΦΨ.
//!
//! Those frames hold the signal's noise, so λⱼ does as well: readings of the untouched skin have a mean square νⱼ along ψⱼ. What is wanted is
//! the image without it, and the estimate of that shrinks each coefficient (Wiener): x̂ = x₀ + Σ max(0, 1 − νⱼ / λⱼ) α̂ⱼ ψⱼ.
//!
//! Pressure is never negative, which the linear estimate does not know: it rings about a contact. So, from x̂ on, what is negative is set to 0 and
//! what then no longer agrees with the measurements is estimated and added, again and again:
//!
//! xₖ₊₁ = (zₖ + B (y − Φzₖ))₊, zₖ₊₁ = xₖ₊₁ + (xₖ₊₁ − xₖ) (tₖ − 1) / tₖ₊₁, tₖ₊₁ = (1 + √(1 + 4 tₖ²)) / 2, t₁ = 1,
//!
//! B the matrix of the linear estimate. Without the momentum these are projections onto the positive images and onto those that measure as y
//! (exactly so, where ΦB = 1), in turn: Youla and Webb (1982), *Image restoration by the method of convex projections*, IEEE Transactions on
//! Medical Imaging 1, 81; the momentum is that of Beck and Teboulle (2009), *A fast iterative shrinkage-thresholding algorithm*, SIAM Journal on
//! Imaging Sciences 2, 183. With noise it would fit that as well, and is left out.
//!
//! A whole frame is its own estimate.

use super::{Basis, Dictionary, Ensemble, Lmmse, Projection, SensedDictionary};
use crate::error::Result;
use crate::random::Seed;
use ndarray::{Array2, ArrayView2};

/// Principal components, at most: what is beyond is the rest. More take longer to find and add what measurements, usually fewer, do not say.
pub const N_COMPONENTS: usize = 512;

/// Readings that the estimate is prepared from, one a row of n taxels, all through the same signal.
#[derive(Clone, Copy, Debug)]
pub struct Readings<'a> {
    /// Of training touches.
    pub training: ArrayView2<'a, f64>,
    /// Of the untouched skin.
    pub untouched: ArrayView2<'a, f64>,
}

/// Images from measurements, ready for any number of frames.
#[derive(Clone, Debug)]
pub struct ImageEstimate {
    /// `None`: measurements are the frame.
    lmmse: Option<(Lmmse, Projection)>,
    noise_std: f64,
}

/// Steps. Fewer leave more of the ringing; each takes as long as the linear estimate and measuring its image again.
const N_PROJECTIONS: usize = 20;

impl ImageEstimate {
    /// Prepares the estimate for a projection of an ny × nx array.
    ///
    /// # Errors
    /// No training readings, or of another length; readings that are not finite; training readings, or a projection, that are zero.
    pub fn new(
        projection: &Projection,
        grid: (usize, usize),
        readings: Readings,
        seed: &Seed,
    ) -> Result<Self> {
        if projection.ensemble() == Ensemble::Identity {
            return Ok(Self {
                lmmse: None,
                noise_std: root_mean_square(readings.untouched),
            });
        }
        let k = N_COMPONENTS.min(projection.n_taxels());
        let dictionary = Dictionary::learned(Basis::Pca, grid, readings.training, Some(k), seed)?;
        let sensed = SensedDictionary::new(projection, &dictionary)?;
        let energy = dictionary.energy().map(|energy| &energy.of_atoms);
        let n_untouched = readings.untouched.nrows().max(1) as f64;
        let of_noise = readings
            .untouched
            .dot(&dictionary.atoms(0..dictionary.n_atoms()).t());
        let of_noise = of_noise.mapv(|c| c * c).sum_axis(ndarray::Axis(0)) / n_untouched;
        let mut shrinkage = of_noise;
        if let Some(energy) = energy {
            shrinkage.zip_mut_with(energy, |noise, all| *noise = (1.0 - *noise / all).max(0.0));
        }
        let lmmse = Lmmse::shrunk(&sensed, 0.0, Some(&shrinkage))?;
        let of_noise = lmmse.linear(projection.measure(readings.untouched).view());
        Ok(Self {
            noise_std: root_mean_square(of_noise.view()),
            lmmse: Some((lmmse, projection.clone())),
        })
    }

    /// Standard deviation of an image's noise on a taxel, from the untouched readings; the images' unit.
    pub fn noise_std(&self) -> f64 {
        self.noise_std
    }

    /// Images of rows of measurements (n_frames × m): n_frames × n.
    ///
    /// # Panics
    /// When a row does not have m values.
    pub fn images(&self, measurements: ArrayView2<f64>) -> Array2<f64> {
        let Some((lmmse, projection)) = &self.lmmse else {
            return measurements.to_owned();
        };
        let mut images = lmmse.estimate(measurements);
        images.mapv_inplace(|value| value.max(0.0));
        if self.noise_std > 0.0 {
            return images;
        }
        let (mut ahead, mut t) = (images.clone(), 1.0_f64);
        for _ in 0..N_PROJECTIONS {
            let unexplained = &measurements - &projection.measure(ahead.view());
            let mut next = ahead + lmmse.linear(unexplained.view());
            next.mapv_inplace(|value| value.max(0.0));
            let t_next = 0.5 * (1.0 + (1.0 + 4.0 * t * t).sqrt());
            ahead = &next + &((&next - &images) * ((t - 1.0) / t_next));
            (images, t) = (next, t_next);
        }
        images
    }
}

fn root_mean_square(values: ArrayView2<f64>) -> f64 {
    let squares: f64 = values.iter().map(|value| value * value).sum();
    (squares / values.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use rand_distr::StandardNormal;

    const GRID: (usize, usize) = (12, 12);

    /// Bumps that lie anywhere.
    fn bumps(n: usize, name: &str) -> Array2<f64> {
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

    fn noise(n: usize, name: &str, std: f64) -> Array2<f64> {
        let mut rng = Seed::new(4).named(name).rng();
        Array2::from_shape_fn((n, 144), |_| std * rng.sample::<f64, _>(StandardNormal))
    }

    fn error(a: &Array2<f64>, b: &Array2<f64>) -> f64 {
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
        let estimate = ImageEstimate::new(&projection, GRID, readings, &Seed::new(2));
        (estimate.unwrap(), projection)
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
            assert!(after < 0.9 * before, "{ensemble:?}: {before} {after}");
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
