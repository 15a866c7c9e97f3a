//! Features of images: from measurements of a trial by way of an estimate of the frame.

use super::measurement::Measurements;
use crate::error::Result;
use crate::random::Seed;
use crate::recognition::features::{Cut, ImageFeatures, Join, Workspace};
use crate::sensing::{ImageEstimate, Projection, Readings};
use ndarray::{Array2, ArrayViewMut2, Axis, s};
use rayon::prelude::*;

/// Frames estimated together: one matrix product. Fixed, so that results do not depend on the number of threads.
const BLOCK: usize = 64;

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
        let estimates = projections.iter().map(|projection| {
            let estimate = ImageEstimate::new(projection, shape, readings, seed)?;
            Ok((projection.n_measurements(), estimate))
        });
        Ok(Self {
            shape,
            full_scale,
            estimates: estimates.collect::<Result<_>>()?,
        })
    }

    /// Features of all frames of some touches, one after the other, from their leading m measurements, into n × F·k; of what is so far behind
    /// the foremost point, as a fraction of the full scale.
    ///
    /// # Panics
    /// An m that it was not made for; rows of another length.
    pub fn features(
        &self,
        (join, foremost, m): (Join, Option<f64>, usize),
        (measured, touches): (&Measurements, &[usize]),
        mut rows: ArrayViewMut2<f64>,
    ) {
        let mut estimates = self.estimates.iter();
        let estimate = estimates.find(|(of, _)| *of == m);
        let (_, estimate) = estimate.expect("an estimate for each m of the group's cells");
        let level = noise_level(estimate.noise_std(), self.shape.0 * self.shape.1);
        let cut = Cut {
            level,
            foremost: foremost.map(|share| share * self.full_scale),
        };
        let features = ImageFeatures::new(join, self.shape, self.full_scale, cut);
        let (n_frames, k) = (measured.n_frames, join.n_values(self.shape));
        let blocks = rows.axis_chunks_iter_mut(Axis(0), BLOCK).into_par_iter();
        let blocks = blocks.zip(touches.par_chunks(BLOCK));
        blocks.for_each_init(Workspace::default, |workspace, (mut rows, touches)| {
            for frame in 0..n_frames {
                let places: Vec<usize> = touches.iter().map(|t| t * n_frames + frame).collect();
                let values = measured.values.slice(s![.., ..m]).select(Axis(0), &places);
                let images: Array2<f64> = estimate.images(values.view());
                let mut own = rows.slice_mut(s![.., frame * k..(frame + 1) * k]);
                for (image, mut out) in images.outer_iter().zip(own.outer_iter_mut()) {
                    let image = image.as_standard_layout();
                    let (image, out) = (image.as_slice(), out.as_slice_mut());
                    let (image, out) = image.zip(out).expect("rows are whole");
                    features.write(image, workspace, out);
                }
            }
        });
    }
}

/// The largest that noise of standard deviation σ is expected to be on n taxels, σ √(2 ln n): what is above it is a contact. Lower, and taxels
/// that nothing touches count; higher, and the rim of a contact does not. (Donoho and Johnstone 1994, Biometrika 81, 425: the universal
/// threshold.)
fn noise_level(noise_std: f64, n_taxels: usize) -> f64 {
    noise_std * (2.0 * (n_taxels as f64).ln()).sqrt()
}
