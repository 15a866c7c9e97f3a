//! Features of images: from measurements of a trial by way of an estimate of the frame.

use super::measurement::{LEARNED_FRAMES, WITH_COPIES};
use crate::error::Result;
use crate::random::Seed;
use crate::recognition::features::{Cut, ImageFeatures, Join, Workspace};
use crate::sensing::{Ensemble, ImageEstimate, ImagePrior, Projection, Readings};
use ndarray::{Array2, ArrayView2, Axis, s};
use rayon::prelude::*;

/// Frames estimated together: one matrix product. Fixed, so that results do not depend on the number of threads.
const BLOCK: usize = 64;

/// What cells of a group learn from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeaturesOfImages {
    /// Which.
    pub join: Join,
    /// Of what is so far behind the foremost point, as a fraction of the full scale.
    pub foremost: Option<f64>,
    /// From how many measurements.
    pub measurements: usize,
}

/// Images of the frames of a group, from so many measurements as its cells have.
#[derive(Clone, Debug)]
pub struct Images {
    /// ny, nx.
    shape: (usize, usize),
    full_scale: f64,
    /// By m.
    estimates: Vec<(usize, ImageEstimate)>,
}

impl Images {
    /// For these projections of one array, its full scale (a reading's unit), and what they are learned from.
    ///
    /// # Errors
    /// What an estimate refuses.
    pub fn new(
        projections: &[Projection],
        (shape, full_scale): ((usize, usize), f64),
        readings: Readings,
        seed: &Seed,
    ) -> Result<Self> {
        let is_whole = |projection: &Projection| projection.ensemble() == Ensemble::Identity;
        let n_frames = match readings.training.nrows() < LEARNED_FRAMES {
            true => WITH_COPIES,
            false => LEARNED_FRAMES,
        };
        let prior = match projections.iter().all(is_whole) {
            true => None,
            false => Some(ImagePrior::learned(shape, readings, n_frames, seed)?),
        };
        let estimates = projections.iter().map(|projection| {
            let estimate = match prior.as_ref().filter(|_| !is_whole(projection)) {
                None => ImageEstimate::of_frames(readings.untouched),
                Some(prior) => ImageEstimate::new(projection, prior)?,
            };
            Ok((projection.n_measurements(), estimate))
        });
        Ok(Self {
            shape,
            full_scale,
            estimates: estimates.collect::<Result<_>>()?,
        })
    }

    /// Whether it makes images of so many measurements.
    pub fn is_of(&self, measurements: usize) -> bool {
        self.estimates.iter().any(|(m, _)| *m == measurements)
    }

    /// Features of all frames of measurements: for each that is wanted n_touches × F·k, k numbers a frame. An image is estimated once for all that is
    /// wanted of it, and cells that learn from the same share them.
    ///
    /// # Panics
    /// An m that it was not made for.
    pub fn features(
        &self,
        (values, n_frames): (ArrayView2<f64>, usize),
        wanted: &[FeaturesOfImages],
    ) -> Vec<Array2<f64>> {
        let n_touches = values.nrows() / n_frames.max(1);
        let empty = |w: &FeaturesOfImages| {
            Array2::zeros((n_touches, n_frames * w.join.n_values(self.shape)))
        };
        let mut all: Vec<Array2<f64>> = wanted.iter().map(empty).collect();
        for (m, estimate) in &self.estimates {
            let of_m = wanted
                .iter()
                .zip(&mut all)
                .filter(|(w, _)| w.measurements == *m);
            let (of_m, mut rows): (Vec<_>, Vec<_>) = of_m
                .map(|(w, rows)| (self.prepared(w, estimate), rows.view_mut()))
                .unzip();
            let mut blocks = Vec::new();
            for start in (0..n_touches).step_by(BLOCK) {
                let n = BLOCK.min(n_touches - start);
                let cut = rows.into_iter().map(|rows| rows.split_at(Axis(0), n));
                let (own, rest): (Vec<_>, Vec<_>) = cut.unzip();
                rows = rest;
                let frames = start * n_frames..(start + n) * n_frames;
                blocks.push((values.slice(s![frames, ..*m]), own));
            }
            let blocks = blocks.into_par_iter();
            blocks.for_each_init(Workspace::default, |workspace, (values, mut rows)| {
                let images = estimate.images(values);
                for (features, rows) in of_m.iter().zip(&mut rows) {
                    let k = rows.ncols() / n_frames;
                    let touches = rows.outer_iter_mut();
                    for (mut row, frames) in touches.zip(images.axis_chunks_iter(Axis(0), n_frames))
                    {
                        let parts = row
                            .as_slice_mut()
                            .expect("rows are whole")
                            .chunks_exact_mut(k);
                        for (out, image) in parts.zip(frames.outer_iter()) {
                            let image = image.as_standard_layout();
                            features.write(
                                image.as_slice().expect("rows are whole"),
                                workspace,
                                out,
                            );
                        }
                    }
                }
            });
        }
        all
    }

    fn prepared(&self, wanted: &FeaturesOfImages, estimate: &ImageEstimate) -> ImageFeatures {
        let foremost = wanted.foremost.map(|share| share * self.full_scale);
        let level = noise_level(estimate.noise_std(), self.shape.0 * self.shape.1);
        let cut = Cut { level, foremost };
        ImageFeatures::new(wanted.join, self.shape, self.full_scale, cut)
    }
}

/// The largest that noise of standard deviation σ is expected to be on n taxels, σ √(2 ln n): what is above it is a contact. Lower, and taxels
/// that nothing touches count; higher, and the rim of a contact does not. (Donoho and Johnstone 1994, Biometrika 81, 425: the universal
/// threshold.)
fn noise_level(noise_std: f64, n_taxels: usize) -> f64 {
    noise_std * (2.0 * (n_taxels as f64).ln()).sqrt()
}
