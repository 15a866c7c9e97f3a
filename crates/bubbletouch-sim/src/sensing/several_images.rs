//! Measurement of frames that consist of several images, such as one image for each kind of value of a taxel.

use super::Ensemble;
use super::ensembles::{Operator, TrainingFrames};
use super::projection::Projection;
use crate::error::Result;
use crate::random::Seed;
use crate::world::ImageShape;
use ndarray::{ArrayView2, ArrayViewMut2, s};
use std::sync::Arc;

/// Returns the number of measurements of each of k images, m in total. The numbers differ by at most 1; the first images have the larger numbers.
fn shares(k: usize, m: usize) -> impl Iterator<Item = usize> {
    (0..k).map(move |image| m / k + usize::from(image < m % k))
}

impl Projection {
    /// Prepares the projection of frames that consist of `k` images of equal shape, one after the other. There may be one image for each kind of value of a
    /// taxel. Each image has a projection of its own with the seed `seed`; m counts the measurements of all images, at least one each. Their numbers differ
    /// by at most 1. One image is measured as by [`learned`](Self::learned).
    ///
    /// # Errors
    /// If m < k, or if an image has no projection.
    ///
    /// # Panics
    /// If k = 0, or if a frame does not have k · n values.
    pub fn of_images<'a>(
        ensemble: Ensemble,
        (k, grid): (usize, ImageShape),
        m: usize,
        (training, seed): (impl Into<TrainingFrames<'a>>, &Seed),
    ) -> Result<Self> {
        let (training, n) = (training.into(), grid.n_values());
        if k == 1 {
            return Self::learned(ensemble, grid, m, (training, seed));
        }
        let image = |(image, m): (usize, usize)| {
            let taxels = image * n..(image + 1) * n;
            let frames = match training.frames.ncols() {
                0 => training.frames,
                _ => training.frames.slice_move(s![.., taxels]),
            };
            let training = TrainingFrames { frames, ..training };
            Self::learned(ensemble, grid, m, (training, seed))
        };
        let images: Vec<Self> = shares(k, m).enumerate().map(image).collect::<Result<_>>()?;
        Ok(Self {
            ensemble: Some(ensemble),
            n_taxels: k * n,
            n_measurements: images.iter().map(Self::n_measurements).sum(),
            operator: Arc::new(SeveralImages::new(images, ensemble.is_prefix_nested())),
        })
    }
}

/// Map of a frame of k equal images, stored one after the other. Each image has its own projection.
///
/// If the ensemble is nested, measurement j of image i is measurement i + j k of the frame, so that the map is nested, too. Otherwise, the measurements of an
/// image follow those of the previous images.
#[derive(Debug)]
struct SeveralImages {
    /// Projection of each image, with the index of its first measurement.
    images: Vec<(usize, Projection)>,
    /// Distance between two successive measurements of an image.
    step: usize,
}

impl SeveralImages {
    fn new(images: Vec<Projection>, is_nested: bool) -> Self {
        let step = if is_nested { images.len() } else { 1 };
        let mut before = 0;
        let place = |(image, projection): (usize, Projection)| {
            let start = if is_nested { image } else { before };
            before += projection.n_measurements();
            (start, projection)
        };
        Self {
            images: images.into_iter().enumerate().map(place).collect(),
            step,
        }
    }
}

impl Operator for SeveralImages {
    fn measure(&self, frames: ArrayView2<f64>, mut out: ArrayViewMut2<f64>) {
        let n_taxels = frames.ncols() / self.images.len();
        for (image, (start, projection)) in self.images.iter().enumerate() {
            let own = frames.slice(s![.., image * n_taxels..(image + 1) * n_taxels]);
            let end = start + (projection.n_measurements() - 1) * self.step + 1;
            let mut out = out.slice_mut(s![.., *start..end; self.step]);
            out.assign(&projection.measure(own));
        }
    }

    fn each_entry(&self, visit: &mut dyn FnMut(usize, usize, f64)) {
        for (image, (start, projection)) in self.images.iter().enumerate() {
            projection.each_entry(|measurement, taxel, value| {
                let taxel = image * projection.n_taxels() + taxel;
                visit(start + measurement * self.step, taxel, value);
            });
        }
    }

    fn row_norm(&self) -> f64 {
        let (mut squares, mut n) = (0.0, 0.0);
        for (_, projection) in &self.images {
            let m = projection.n_measurements() as f64;
            squares += m * projection.row_norm().powi(2);
            n += m;
        }
        (squares / n).sqrt()
    }
}
