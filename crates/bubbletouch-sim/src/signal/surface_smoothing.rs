//! Gaussian smoothing on a skin that is not a grid.
//!
//! xᵢ ← Σⱼ wᵢⱼ xⱼ / Σⱼ wᵢⱼ, wᵢⱼ = exp(−½ (dᵢⱼ / w)²), over all taxels whose distance d along the surface ([`Neighbours`]) is at most 4 w. w is the width (σ) in
//! metres, as on a grid. Taxels beyond an edge have no weight; a uniform frame is unchanged.

use super::sensor_error::Effect;
use crate::error::{Error, Result};
use crate::world::{Neighbours, Patch};

/// Radius at which the Gaussian kernel is cut off, in multiples of its standard deviation.
const TRUNCATE: f64 = 4.0;
/// Maximum number of smoothing weights of a skin; this many weights need one gigabyte.
const MAX_WEIGHTS: usize = 1 << 26;

/// Gaussian smoothing with one width, for one skin that is not a grid.
#[derive(Debug)]
pub(super) struct SurfaceSmoothing {
    /// Index in `weights` of the first weight of each taxel, followed by the total number of weights.
    starts: Vec<usize>,
    taxels: Vec<u32>,
    /// Smoothing weights, taxel by taxel; the weights of each taxel have sum 1.
    weights: Vec<f64>,
}

impl SurfaceSmoothing {
    /// Prepares Gaussian smoothing for a skin. `width` is the standard deviation of the kernel, metres, zero or positive.
    ///
    /// # Errors
    /// If the width is negative or not finite, or if there are more than [`MAX_WEIGHTS`] pairs of taxels within four widths.
    pub fn new(width: f64, skin: &Patch) -> Result<Self> {
        let refused =
            |allowed: &str| Error::input("smoothing width", format!("{width} m"), allowed);
        if !(width >= 0.0 && width.is_finite()) {
            return Err(refused("zero or a positive number"));
        }
        let neighbours = Neighbours::new(skin);
        let mut smoothing = Self {
            starts: vec![0],
            taxels: Vec::new(),
            weights: Vec::new(),
        };
        for taxel in 0..skin.n_taxels() {
            let mut near = neighbours.within(skin, taxel, TRUNCATE * width);
            if smoothing.taxels.len() + near.len() > MAX_WEIGHTS {
                return Err(refused(
                    "fewer than 67,108,864 pairs of taxels within four widths",
                ));
            }
            near.sort_unstable_by_key(|(other, _)| *other);
            let weight = |distance: f64| match distance == 0.0 {
                true => 1.0,
                false => (-0.5 * (distance / width).powi(2)).exp(),
            };
            let sum: f64 = near.iter().map(|(_, distance)| weight(*distance)).sum();
            for (other, distance) in near {
                smoothing.taxels.push(other as u32);
                smoothing.weights.push(weight(distance) / sum);
            }
            smoothing.starts.push(smoothing.taxels.len());
        }
        Ok(smoothing)
    }
}

impl Effect for SurfaceSmoothing {
    fn scratch_len(&self) -> usize {
        self.starts.len() - 1
    }

    fn apply_to_frame(&self, frame: &mut [f64], scratch: &mut [f64]) {
        let felt = &mut scratch[..frame.len()];
        felt.copy_from_slice(frame);
        for (out, ends) in frame.iter_mut().zip(self.starts.windows(2)) {
            let own = ends[0]..ends[1];
            let parts = self.taxels[own.clone()].iter().zip(&self.weights[own]);
            *out = parts
                .map(|(&other, weight)| weight * felt[other as usize])
                .sum();
        }
    }
}
