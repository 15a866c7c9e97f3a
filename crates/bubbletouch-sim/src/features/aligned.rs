//! Feature "aligned": the image with its centroid shifted to the middle and its principal axes rotated to the axes of the array. The image is sampled at a
//! quarter of its taxels.
//!
//! With the central moments μ_pq = Σ δ (x − x̄)ᵖ (y − ȳ)^q, the longer principal axis is at the angle φ = ½ atan2(2 μ₁₁, μ₂₀ − μ₀₂). Its direction
//! is chosen so that Σ δ a³ > 0, a along it; the other axis is a quarter turn from it. Values are sampled at every second
//! taxel of the rotated grid, interpolated bilinearly, and are 0 beyond the array.
//!
//! The feature is invariant to quarter turns, and to shifts by whole taxels that keep the contact on the array. For other motions the sampling limits the
//! invariance. An image with two equal principal moments (a disc, a square) has no axes. If its moments are nearly equal, or its third moment is near 0, noise
//! determines the rotation. The feature `polar_harmonics` needs no axes.
//!
//! Source: Hu (1962), *Visual pattern recognition by moment invariants*, IRE Transactions on Information Theory 8, 179, section III.

use super::feature::{Feature, FeatureAbout, FeatureWorkspace};
use super::image::{Image, Touched};
use crate::world::ImageShape;

/// Distance between samples of the rotated grid, in taxels.
const STEP: usize = 2;

pub(super) const ABOUT: FeatureAbout = FeatureAbout {
    words: "aligned",
    n_values: |ImageShape { ny, nx }| ny.div_ceil(STEP) * nx.div_ceil(STEP),
    prepare: |_, _| Box::new(Aligned),
};

#[derive(Debug)]
struct Aligned;

impl Feature for Aligned {
    fn write(&self, image: &Image, _: &mut FeatureWorkspace, out: &mut [f64]) {
        let (sine, cosine) = axis(image);
        let (x, y) = image.centroid;
        let (columns, rows) = (image.nx.div_ceil(STEP), image.ny.div_ceil(STEP));
        let from_middle = |i: usize, n: usize| (STEP * i) as f64 - 0.5 * (STEP * (n - 1)) as f64;
        for (row, out) in out.chunks_exact_mut(columns).enumerate() {
            let across = from_middle(row, rows);
            for (column, to) in out.iter_mut().enumerate() {
                let along = from_middle(column, columns);
                *to = image.at(
                    x + cosine * along - sine * across,
                    y + sine * along + cosine * across,
                );
            }
        }
    }
}

/// Returns the sine and cosine of the angle of the longer principal axis. The axis points to the side where the third moment along it is positive.
fn axis(image: &Image) -> (f64, f64) {
    let (x, y) = image.centroid;
    let from_centroid = || {
        let Touched {
            x: columns,
            y: rows,
            value,
        } = &image.touched;
        let places = columns.iter().zip(rows).zip(value);
        places.map(move |((column, row), &value)| (column - x, row - y, value))
    };
    let (mut along_x, mut along_y, mut across) = (0.0, 0.0, 0.0);
    for (x, y, value) in from_centroid() {
        along_x += value * x * x;
        along_y += value * y * y;
        across += value * x * y;
    }
    let (sine, cosine) = (0.5 * f64::atan2(2.0 * across, along_x - along_y)).sin_cos();
    let third: f64 = from_centroid()
        .map(|(x, y, value)| value * (cosine * x + sine * y).powi(3))
        .sum();
    match third < 0.0 {
        true => (-sine, -cosine),
        false => (sine, cosine),
    }
}

#[cfg(test)]
mod tests {
    use super::super::ImageFeature;
    use super::super::tests::features_of;
    use crate::world::ImageShape;

    #[test]
    fn a_wedge_in_any_direction_becomes_one_along_x() {
        let side = 41;
        let wedge = |angle: f64| -> Vec<f64> {
            let (sine, cosine) = angle.sin_cos();
            let value = |i: usize| {
                let (x, y) = ((i % side) as f64 - 20.0, (i / side) as f64 - 20.0);
                let (a, b) = (cosine * x + sine * y, cosine * y - sine * x);
                let inside = (1.0 - (a / 16.0).powi(2)) * (1.0 - (b / 6.0).powi(2));
                match a.abs() < 16.0 && b.abs() < 6.0 {
                    true => inside * (1.2 + a / 16.0),
                    false => 0.0,
                }
            };
            (0..side * side).map(value).collect()
        };
        let of = |angle| {
            features_of(
                ImageFeature::Aligned,
                ImageShape { ny: side, nx: side },
                &wedge(angle),
            )
        };
        let straight = of(0.0);
        let size = straight.iter().map(|v| v * v).sum::<f64>();
        for degrees in [20.0, 77.0, 135.0, 200.0, 301.0_f64] {
            let turned = of(degrees.to_radians());
            let pairs = straight.iter().zip(&turned);
            let error: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
            assert!(error < 5e-3 * size, "{degrees}: {}", error / size);
        }
    }
}
