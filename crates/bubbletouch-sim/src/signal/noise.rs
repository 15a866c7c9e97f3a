//! Additive Gaussian noise.

use super::taxel_effect::TaxelEffect;
use super::{Effect, Quantity, TouchRead};
use crate::error::{Error, Result};
use crate::random::{CounterKey, Seed};
use crate::text::in_range::not_negative;
use crate::world::Taxel;
use rand::Rng;
use rand_distr::StandardNormal;
use serde::{Deserialize, Serialize};

/// Unit of the standard deviation of the noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NoiseUnit {
    /// Fraction of the full scale. The full scale is the stroke for deflections, and the stroke times the stiffness for forces.
    FullScale,
    /// Millimetres of deflection.
    Mm,
    /// Newtons of force.
    N,
}

/// Independent zero-mean Gaussian noise on every taxel, touched or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Standard deviation of the noise, in `unit`; zero or positive.
    pub std: f64,
    /// Unit of the standard deviation.
    pub unit: NoiseUnit,
}

impl Noise {
    /// Returns the standard deviation of the noise in the unit of the frame: metres for deflections, newtons for forces.
    ///
    /// # Errors
    /// If `std` is negative or not finite, or its unit does not fit: millimetres for forces, or newtons for deflections.
    pub fn std_of(&self, quantity: Quantity, taxel: &Taxel) -> Result<f64> {
        not_negative("noise std", self.std, "")?;
        match (self.unit, quantity) {
            (NoiseUnit::FullScale, Quantity::Deflection) => Ok(self.std * taxel.stroke),
            (NoiseUnit::FullScale, Quantity::Force) => {
                Ok(self.std * taxel.stroke * taxel.stiffness)
            }
            (NoiseUnit::Mm, Quantity::Deflection) => Ok(self.std * 1e-3),
            (NoiseUnit::N, Quantity::Force) => Ok(self.std),
            (NoiseUnit::Mm, Quantity::Force) => Err(Error::input(
                "noise unit",
                "mm on frames that are forces by then",
                "n or full_scale, or noise listed before force",
            )),
            (NoiseUnit::N, Quantity::Deflection) => Err(Error::input(
                "noise unit",
                "n on frames that are still deflections",
                "mm or full_scale, or noise listed after force",
            )),
        }
    }
}

/// Noise of standard deviation `std` in the unit of the frames, prepared for a chain. The normal numbers of a frame are drawn from the start of a stream and do not
/// depend on `std`. If `std` is 0, no number is drawn.
#[derive(Debug)]
pub(super) struct NoiseOfFrames {
    pub std: f64,
    /// Place among the noise steps of the chain, from 1; each place has its own stream.
    pub place: u64,
}

impl Effect for NoiseOfFrames {
    fn apply(&self, frames: &mut [f64], touch: &TouchRead, _: &mut [f64]) {
        if self.std == 0.0 {
            return;
        }
        let frames = &mut frames[touch.n_before * touch.n_taxels..];
        let n_frames = frames.len() / touch.n_taxels;
        for (number, frame) in frames.chunks_exact_mut(touch.n_taxels).enumerate() {
            let seed = frame_seed(touch.seed, number, n_frames);
            let mut rng = seed.named("noise").numbered(self.place).rng();
            for value in frame {
                let z: f64 = rng.sample(StandardNormal);
                *value += self.std * z;
            }
        }
    }
}

/// Returns the seed of one frame of a touch; the last frame has the seed of the touch.
fn frame_seed(touch: &Seed, frame: usize, n_frames: usize) -> Seed {
    match frame + 1 == n_frames {
        true => *touch,
        false => touch.named("frame").numbered(frame as u64 + 1),
    }
}

/// Prepares noise for a whole body; its numbers are counter-based, indexed by taxel and frame. `std` has the unit of the frame.
pub(super) fn by_taxel(std: f64, key: CounterKey) -> TaxelEffect {
    TaxelEffect::new(move |chunk, moment, values| {
        chunk.draw_sum(key, [(moment.frame, std)]);
        chunk.each(values, |value, noise| value + noise);
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TAXEL: Taxel = Taxel {
        radius: 1e-3,
        stiffness: 200.0,
        damping: 0.0,
        stroke: 5e-3,
    };

    fn std_of(std: f64, unit: NoiseUnit, quantity: Quantity) -> Result<f64> {
        Noise { std, unit }.std_of(quantity, &TAXEL)
    }

    #[test]
    fn full_scale_is_the_stroke_or_the_force_at_the_stroke() {
        let deflection = std_of(0.1, NoiseUnit::FullScale, Quantity::Deflection).unwrap();
        let force = std_of(0.1, NoiseUnit::FullScale, Quantity::Force).unwrap();
        assert!((deflection - 0.5e-3).abs() < 1e-18);
        assert!((force - 0.1).abs() < 1e-15);
        let millimetres = std_of(0.5, NoiseUnit::Mm, Quantity::Deflection).unwrap();
        assert!((millimetres - deflection).abs() < 1e-18);
        assert_eq!(std_of(0.1, NoiseUnit::N, Quantity::Force).unwrap(), 0.1);
    }

    #[test]
    fn a_unit_that_the_frame_does_not_have_is_refused() {
        let newtons = std_of(0.1, NoiseUnit::N, Quantity::Deflection).unwrap_err();
        assert!(newtons.to_string().contains("still deflections"));
        let millimetres = std_of(0.1, NoiseUnit::Mm, Quantity::Force).unwrap_err();
        assert!(millimetres.to_string().contains("forces by then"));
    }
}
