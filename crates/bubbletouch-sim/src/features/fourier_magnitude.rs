//! Feature "Fourier magnitude": √|F(u, v)| at low frequencies, 925 numbers for 64 × 64 taxels.
//!
//! A cyclic shift multiplies F(u, v) by a phase only, so |F| is invariant. Frequencies are u = 0 … ⌊nx/3⌋ and
//! |v| ≤ ⌊ny/3⌋, two thirds of the resolution; higher frequencies contain mainly edges of single taxels and noise. Each frequency occurs once
//! (for u = 0, v ≥ 0). The square root brings strong and weak frequencies closer, as it stabilises the variance of counts.
//!
//! Source: Casasent and Psaltis (1976), *Position, rotation, and scale invariant optical correlation*, Applied Optics 15, 1795.

use super::feature::{Feature, FeatureAbout, FeatureWorkspace};
use super::image::Image;
use super::spectrum::Spectrum;
use crate::world::ImageShape;

pub(super) const ABOUT: FeatureAbout = FeatureAbout {
    words: "Fourier magnitude",
    n_values: |ImageShape { ny, nx }| {
        let (u, v) = (nx / 3, ny / 3);
        u * (2 * v + 1) + v + 1
    },
    prepare: |shape, _| {
        Box::new(FourierMagnitude(
            Spectrum::new(shape, shape.nx / 3),
            shape.ny,
        ))
    },
};

/// Fourier transform of the image, and the number of rows of the image.
#[derive(Debug)]
struct FourierMagnitude(Spectrum, usize);

impl Feature for FourierMagnitude {
    fn write(&self, image: &Image, workspace: &mut FeatureWorkspace, out: &mut [f64]) {
        let Self(spectrum, ny) = self;
        spectrum.transform(image, &mut workspace.fourier);
        let columns = workspace.fourier.magnitudes.chunks_exact(*ny);
        let last = ny / 3;
        let mut kept = out.iter_mut();
        for (u, column) in columns.enumerate() {
            let negative = if u == 0 { ny..ny } else { &(ny - last)..ny };
            let rows = column[..=last]
                .iter()
                .chain(&column[*negative.start..*negative.end]);
            for (magnitude, to) in rows.zip(kept.by_ref()) {
                *to = magnitude.sqrt();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::spectrum::tests::by_definition;
    use super::super::tests::{features_of, frame};
    use super::super::{Cut, Image, ImageFeature};
    use crate::world::ImageShape;

    #[test]
    fn they_are_square_roots_of_the_magnitudes_of_the_definition() {
        let shape = ImageShape { ny: 9, nx: 12 };
        let frame = frame(shape);
        let mut image = Image::default();
        image.read(&frame, shape.nx, Cut::default());
        let mut expected = Vec::new();
        for u in 0..=4 {
            let rows: Vec<isize> = match u {
                0 => (0..=3).collect(),
                _ => (0..=3).chain(-3..=-1).collect(),
            };
            expected.extend(rows.iter().map(|&v| by_definition(&image, u, v).sqrt()));
        }
        let found = features_of(ImageFeature::FourierMagnitude, shape, &frame);
        assert_eq!(found.len(), expected.len());
        let pairs = found.iter().zip(&expected);
        pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-7, "{a} {b}"));
    }
}
