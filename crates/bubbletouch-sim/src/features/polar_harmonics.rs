//! Feature "polar harmonics": square roots of angular harmonics of the image, in rings about the centroid of its pressure (416 numbers).
//!
//! The centroid is (x̄, ȳ) = Σ δ (x, y) / Σ δ. With rings of radius r = (j + ½) h / 26, j = 0 … 25, where h is half the shorter side, the feature is
//!
//! f(j, k)² = |Σ_θ δ(x̄ + r cos θ, ȳ + r sin θ) exp(−ikθ)| / 32, θ in 32 equal steps, k = 0 … 15.
//!
//! The value δ between taxels is interpolated bilinearly, and is 0 beyond the array. The centroid moves with the contact, and a rotation of the image rotates
//! the rings. The feature is exactly invariant to quarter turns. The feature is also exactly invariant to shifts by whole taxels as long as no ring that meets
//! the contact leaves the array. For other motions the sampling by taxels limits the invariance. The root brings weak harmonics closer to strong ones.
//!
//! Source: the angular part of Sheng and Arsenault (1986), JOSA A 3, 771, without the transform before it.

use super::feature::{Feature, FeatureAbout, FeatureWorkspace};
use super::image::Image;
use super::rings::{Rings, roots};
use crate::world::ImageShape;
use std::f64::consts::TAU;

/// Number of rings around the centroid; on 64 × 64 taxels the rings are 1.2 pitches apart.
const N_RINGS: usize = 26;
/// Number of sampled angles per ring, a multiple of 4, so that a quarter turn is a whole number of steps.
const N_ANGLES: usize = 32;
/// Number of harmonics per ring: all except the highest, which 32 samples cannot distinguish from its mirror image.
const N_HARMONICS: usize = 16;

pub(super) const ABOUT: FeatureAbout = FeatureAbout {
    words: "polar harmonics",
    n_values: |_| N_RINGS * N_HARMONICS,
    prepare: |shape, _| Box::new(PolarHarmonics::new(shape)),
};

#[derive(Debug)]
struct PolarHarmonics {
    rings: Rings,
    /// Offsets of the sampled positions from the centroid, ring after ring, in columns and rows.
    places: Vec<(f64, f64)>,
}

impl PolarHarmonics {
    fn new(ImageShape { ny, nx }: ImageShape) -> Self {
        let half = 0.5 * ny.min(nx) as f64;
        let places = (0..N_RINGS).flat_map(|ring| {
            (0..N_ANGLES).map(move |step| {
                let radius = (ring as f64 + 0.5) * half / N_RINGS as f64;
                let (sine, cosine) = (TAU * step as f64 / N_ANGLES as f64).sin_cos();
                (radius * cosine, radius * sine)
            })
        });
        Self {
            rings: Rings::new(N_ANGLES, N_HARMONICS),
            places: places.collect(),
        }
    }
}

impl Feature for PolarHarmonics {
    fn write(&self, image: &Image, workspace: &mut FeatureWorkspace, out: &mut [f64]) {
        image.write_at(&self.places, image.centroid, &mut workspace.rings.values);
        self.rings.write(&mut workspace.rings, out);
        roots(out);
    }
}

#[cfg(test)]
mod tests {
    use super::super::Cut;
    use super::super::ImageFeature;
    use super::super::tests::features_of;
    use super::*;

    /// Compares the harmonics of a plane with the exact ones. For a plane δ = 1 + 0.1 (x − x̄) over a disc, harmonic 0 is 1 and harmonic 1 is 0.05 r. Bilinear
    /// interpolation is exact on planes.
    #[test]
    fn harmonics_of_a_plane_are_its_height_and_its_slope() {
        let shape = ImageShape { ny: 64, nx: 64 };
        let frame: Vec<f64> = (0..4096)
            .map(|i| 1.0 + 0.01 * ((i % 64) as f64 - 31.5))
            .collect();
        let found = features_of(ImageFeature::PolarHarmonics, shape, &frame);
        let mut image = Image::default();
        image.read(&frame, 64, Cut::default());
        let height = 1.0 + 0.01 * (image.centroid.0 - 31.5);
        for ring in 0..16 {
            let radius = (ring as f64 + 0.5) * 32.0 / 26.0;
            let [zero, one, two] = [0, 1, 2].map(|k| found[ring * N_HARMONICS + k].powi(2));
            assert!((zero - height).abs() < 1e-12, "{ring}");
            assert!((one - 0.005 * radius).abs() < 1e-12, "{ring}");
            assert!(two < 1e-12, "{ring}");
        }
    }
}
