//! Feature "Fourier–Mellin": angular harmonics of √|F| in rings about frequency 0, 216 numbers.
//!
//! A shift does not change |F|, and a rotation of the image by φ rotates |F| by φ. The magnitude of a harmonic around a ring does not change if the
//! ring is rotated. With ρⱼ = j / 72 cycles per taxel, j = 1 … 24 (up to a third), and θ over half a turn, since |F(−ω)| = |F(ω)|:
//!
//! f(j, k) = |Σ_θ √|F(ρⱼ cos θ, ρⱼ sin θ)| exp(−2ikθ)| / 36, θ = 0, 5°, … 175°, k = 0 … 8.
//!
//! |F| between integer frequencies is interpolated bilinearly. The feature is exactly invariant to cyclic shifts and to quarter turns of a square image;
//! for other rotations the sampling by taxels limits the invariance.
//!
//! The feature differs from the Fourier–Mellin transform, which uses log ρ and is also invariant to scale. Invariance to scale would make small and large
//! objects of one shape indistinguishable.
//!
//! Source: Sheng and Arsenault (1986), *Experiments on pattern recognition using invariant Fourier–Mellin descriptors*, JOSA A 3, 771.

use super::feature::{Feature, FeatureAbout, FeatureWorkspace};
use super::image::Image;
use super::rings::{Rings, roots};
use super::spectrum::Spectrum;
use crate::world::ImageShape;
use std::f64::consts::PI;

/// Number of rings in the frequency plane, equally spaced up to a third of a cycle per taxel.
const N_RINGS: usize = 24;
const LAST_RING: f64 = 1.0 / 3.0;
/// Number of directions in the frequency plane over half a turn; even, so that a quarter turn is a whole number of steps.
const N_ANGLES: usize = 36;
/// Number of angular harmonics: 0, 2, … 16 periods in a whole turn. Low harmonics describe the edges of contacts; higher harmonics contain mostly noise.
const N_HARMONICS: usize = 9;

pub(super) const ABOUT: FeatureAbout = FeatureAbout {
    words: "Fourier–Mellin",
    n_values: |_| N_RINGS * N_HARMONICS,
    prepare: |shape, _| Box::new(FourierMellin::new(shape)),
};

#[derive(Debug)]
struct FourierMellin {
    spectrum: Spectrum,
    rings: Rings,
    /// Interpolation indices and weights for each point of the rings, ring after ring.
    reads: Vec<Read>,
}

/// Indices of four values of the spectrum, with their interpolation weights.
type Read = [(u32, f64); 4];

impl FourierMellin {
    fn new(ImageShape { ny, nx }: ImageShape) -> Self {
        let spectrum = Spectrum::new(ImageShape { ny, nx }, (nx as f64 * LAST_RING) as usize + 1);
        let places = (1..=N_RINGS).flat_map(|ring| {
            (0..N_ANGLES).map(move |step| {
                let radius = LAST_RING * ring as f64 / N_RINGS as f64;
                let (sine, cosine) = (PI * step as f64 / N_ANGLES as f64).sin_cos();
                (radius * cosine * nx as f64, radius * sine * ny as f64)
            })
        });
        Self {
            reads: places
                .map(|place| read(place, &spectrum, ImageShape { ny, nx }))
                .collect(),
            rings: Rings::new(N_ANGLES, N_HARMONICS),
            spectrum,
        }
    }
}

/// Returns indices and weights of the four integer frequencies around the frequency (u, v). The spectrum's magnitude has the period of the array, and is
/// equal at (−u, −v) and (u, v).
fn read((u, v): (f64, f64), spectrum: &Spectrum, ImageShape { ny, nx }: ImageShape) -> Read {
    let (left, below) = (u.floor(), v.floor());
    let (along, up) = (u - left, v - below);
    let place = |right: f64, above: f64| {
        let u = (left + right).rem_euclid(nx as f64) as usize;
        let v = (below + above).rem_euclid(ny as f64) as usize;
        let (u, v) = match u < spectrum.n_columns() {
            true => (u, v),
            false => ((nx - u) % nx, (ny - v) % ny),
        };
        (u * ny + v) as u32
    };
    [
        (place(0.0, 0.0), (1.0 - along) * (1.0 - up)),
        (place(1.0, 0.0), along * (1.0 - up)),
        (place(0.0, 1.0), (1.0 - along) * up),
        (place(1.0, 1.0), along * up),
    ]
}

impl Feature for FourierMellin {
    fn write(&self, image: &Image, workspace: &mut FeatureWorkspace, out: &mut [f64]) {
        let FeatureWorkspace { fourier, rings, .. } = workspace;
        self.spectrum.transform(image, fourier);
        rings.values.resize(self.reads.len(), 0.0);
        write_reads(&self.reads, &fourier.magnitudes, &mut rings.values);
        roots(&mut rings.values);
        self.rings.write(rings, out);
    }
}

/// Writes one interpolated magnitude for each entry of `reads`: the weighted sum of four stored magnitudes.
fn write_reads(reads: &[Read], magnitudes: &[f64], out: &mut [f64]) {
    for (to, read) in out.iter_mut().zip(reads) {
        let [a, b, c, d] = read.map(|(place, weight)| weight * magnitudes[place as usize]);
        *to = a + b + c + d;
    }
}

#[cfg(test)]
mod tests {
    use super::super::spectrum::tests::by_definition;
    use super::super::tests::{features_of, frame};
    use super::super::{Cut, Image, ImageFeature};
    use super::*;

    /// Compares all values of the feature with their definition, frequency by frequency.
    #[test]
    fn they_are_what_the_equation_says() {
        let shape = ImageShape { ny: 12, nx: 10 };
        let frame = frame(shape);
        let mut image = Image::default();
        image.read(&frame, shape.nx, Cut::default());
        let found = features_of(ImageFeature::FourierMellin, shape, &frame);
        let between = |u: f64, v: f64| {
            let (left, below) = (u.floor() as isize, v.floor() as isize);
            let (along, up) = (u - u.floor(), v - v.floor());
            let row = |v: isize| {
                (1.0 - along) * by_definition(&image, left, v)
                    + along * by_definition(&image, left + 1, v)
            };
            (1.0 - up) * row(below) + up * row(below + 1)
        };
        for (ring, harmonic) in [(1, 0), (5, 3), (16, 8), (24, 1)] {
            let radius = ring as f64 / 72.0;
            let (mut re, mut im) = (0.0, 0.0);
            for step in 0..36 {
                let theta = PI * step as f64 / 36.0;
                let magnitude = between(10.0 * radius * theta.cos(), 12.0 * radius * theta.sin());
                let angle = -2.0 * harmonic as f64 * theta;
                re += magnitude.sqrt() * angle.cos();
                im += magnitude.sqrt() * angle.sin();
            }
            let expected = f64::hypot(re, im) / 36.0;
            let found = found[(ring - 1) * N_HARMONICS + harmonic];
            assert!((found - expected).abs() < 1e-7, "{found} {expected}");
        }
    }
}
