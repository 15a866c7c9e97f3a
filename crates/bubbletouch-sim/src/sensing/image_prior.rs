//! Statistics of images, learned from frames of training touches.
//!
//! Statistics of few frames overfit: images of training touches would be more accurate than images of test touches. A classifier trained on accurate images
//! would misclassify the less accurate ones. Shifted and mirrored copies of the frames reduce this effect.

use super::dictionary::{Dictionary, check_training};
use super::pca::Pca;
use crate::error::Result;
use crate::random::Seed;
use crate::world::ImageShape;
use ndarray::{Array1, Array2, ArrayView2, Axis, s};
use rand::Rng;

/// Maximum number of principal components; the variance of other components counts as noise. More components take longer to compute and rarely help, because
/// there are usually fewer measurements.
pub const N_COMPONENTS: usize = 512;

/// Readings from which the statistics are learned, one row of n taxels each; one signal chain has processed all of them.
#[derive(Clone, Copy, Debug)]
pub struct Readings<'a> {
    /// Readings of training touches.
    pub training: ArrayView2<'a, f64>,
    /// Readings of the untouched skin.
    pub untouched: ArrayView2<'a, f64>,
}

/// Statistics of images that an estimator needs, independent of the projection.
#[derive(Clone, Debug)]
pub struct ImagePrior {
    /// Dictionary of the principal components, with the mean square of each coefficient.
    pub(super) dictionary: Dictionary,
    /// Wiener factor of each component, 0 to 1. The factor is one minus the mean square of the coefficient's noise divided by the mean square of the
    /// coefficient, but at least 0.
    pub(super) shrinkage: Array1<f64>,
    pub(super) untouched: Array2<f64>,
}

/// Largest shift of copies of training frames, relative to the sides of the array. If larger, contacts leave the array; if smaller, few frames cover some
/// positions.
const MOVED: f64 = 0.25;

impl ImagePrior {
    /// Learns the statistics of images of an ny × nx array from about `n_frames` frames: training readings and, if these are too few, shifted copies.
    ///
    /// # Errors
    /// If there are no training readings, if they have another length, or if readings are not finite.
    pub fn learned(
        grid: ImageShape,
        readings: Readings,
        n_frames: usize,
        seed: &Seed,
    ) -> Result<Self> {
        let k = N_COMPONENTS.min(grid.n_values());
        let training = with_copies(readings.training, grid, n_frames, seed);
        check_training(grid, training.view(), Some(k))?;
        let dictionary = Dictionary::of_components(grid, Pca::new(training, k, seed));
        let n_untouched = readings.untouched.nrows().max(1) as f64;
        let atoms = dictionary.atoms(0..dictionary.n_atoms());
        let of_noise = readings.untouched.dot(&atoms.t());
        let mut shrinkage = of_noise.mapv(|c| c * c).sum_axis(Axis(0)) / n_untouched;
        if let Some(energy) = dictionary.energy() {
            shrinkage.zip_mut_with(&energy.of_atoms, |noise, all| {
                *noise = (1.0 - *noise / all).max(0.0);
            });
        }
        Ok(Self {
            dictionary,
            shrinkage,
            untouched: readings.untouched.to_owned(),
        })
    }
}

/// Returns the frames, followed by equally many copies of each frame, up to `n_frames` in total. Copies are shifted by up to a quarter of the array and may be
/// mirrored. Shifted images are equally likely, and more frames reduce overfitting.
pub(super) fn with_copies(
    frames: ArrayView2<f64>,
    ImageShape { ny, nx }: ImageShape,
    n_frames: usize,
    seed: &Seed,
) -> Array2<f64> {
    let n_each = (n_frames / frames.nrows().max(1)).max(1);
    let mut all = Array2::zeros((n_each * frames.nrows(), frames.ncols()));
    all.slice_mut(s![..frames.nrows(), ..]).assign(&frames);
    let mut rng = seed.named("copies").rng();
    let rest = all.outer_iter_mut().skip(frames.nrows());
    for (mut copy, frame) in rest.zip(frames.outer_iter().cycle()) {
        let mut place = |n: usize| {
            let most = (MOVED * n as f64) as isize;
            (rng.gen_range(-most..=most), rng.r#gen::<bool>())
        };
        let (along_y, along_x) = (place(ny), place(nx));
        // Source index of the value at a position, if it is on the array.
        let from = |at: usize, (by, is_mirrored): (isize, bool), n: usize| {
            let from = at.checked_add_signed(-by).filter(|&from| from < n)?;
            Some(if is_mirrored { n - 1 - from } else { from })
        };
        for y in 0..ny {
            for x in 0..nx {
                if let (Some(row), Some(column)) = (from(y, along_y, ny), from(x, along_x, nx)) {
                    copy[y * nx + x] = frame[row * nx + column];
                }
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::super::image_estimate::tests::{GRID, bumps, error, estimated};
    use super::super::{Ensemble, Projection};
    use super::*;

    #[test]
    fn copies_tell_of_places_that_few_frames_do_not_have() {
        let frames = bumps(30, "training");
        assert_eq!(with_copies(frames.view(), GRID, 59, &Seed::new(1)), frames);
        let copies = with_copies(frames.view(), GRID, 305, &Seed::new(1));
        assert_eq!(copies.nrows(), 300);
        assert_eq!(copies.slice(s![..30, ..]), frames);
        // Each copy is its shifted frame: its values come from that frame, and none is repeated.
        for (copy, frame) in copies.outer_iter().zip(frames.outer_iter().cycle()) {
            let sorted = |values: ndarray::ArrayView1<f64>| {
                let mut values: Vec<f64> = values.iter().copied().filter(|&v| v > 0.0).collect();
                values.sort_by(f64::total_cmp);
                values
            };
            let (mut left, mut whole) = (sorted(copy), sorted(frame).into_iter());
            left.retain(|value| !whole.any(|other| other == *value));
            assert_eq!(left, Vec::<f64>::new());
        }
        let projection = Projection::new(Ensemble::BlockAverage, GRID, 16, &Seed::new(1)).unwrap();
        let untouched = Array2::zeros((4, 144));
        let readings = Readings {
            training: frames.view(),
            untouched: untouched.view(),
        };
        let test = bumps(100, "test");
        let measured = projection.measure(test.view());
        let [few, many] = [30, 600].map(|n_frames| {
            let estimate = estimated(&projection, readings, n_frames);
            error(&estimate.images(measured.view()), &test)
        });
        assert!(many < 0.9 * few, "{few} {many}");
    }
}
