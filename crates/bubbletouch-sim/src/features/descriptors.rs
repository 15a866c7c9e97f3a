//! Feature "descriptors": 126 numbers that describe areas by depth, the spread of the pressure, and its decrease with the distance from the centroid.
//!
//! | numbers | of |
//! |---|---|
//! | 3 | the largest δ, Σ δ, √Σ δ² |
//! | 24 | √(taxels with δ ≥ ℓ) at ℓ = k s / 24, s the full scale, k = 1 … 24 |
//! | 24 | the same at ℓ = k δ_max / 25: relative to the deepest |
//! | 24 | the same at δ_max − ℓ: how wide the object is so far behind its foremost point, however deep it is pressed |
//! | 3 × 9 | [moments](super::moments) of δ, of the touched taxels, and of those above half of the largest |
//! | 24 | Σ δ / (area) in rings about the centroid, r from k h / 24 to (k + 1) h / 24, h half the shorter side |
//!
//! The square root of an area is a length, as are the other numbers. Each number is a sum over touched taxels that depends on their positions only through
//! distances from the centroid. Descriptors are exactly invariant to shifts that keep the contact on the array and to quarter turns. Descriptors are also
//! invariant to mirror images, except for two of the moments, which change sign. For other rotations the sampling limits the invariance.
//!
//! Sources: Hu (1962), IRE Transactions on Information Theory 8, 179 (moments). Level sets and radial profiles are common in granulometry: Serra (1982), *Image
//! Analysis and Mathematical Morphology*.

use super::feature::{Feature, FeatureAbout, FeatureWorkspace};
use super::image::{Image, Touched};
use super::moments::{N_MOMENTS, Weight, moments};
use multiversion::multiversion;
use std::f64::consts::PI;

/// Number of depth levels of each kind of area, and number of rings. In a 64 × 64 image pressed to half its stroke, steps of full scale / 24 are
/// distinguishable.
const N_LEVELS: usize = 24;
const N_RINGS: usize = 24;
const N_VALUES: usize = 3 + 3 * N_LEVELS + 3 * N_MOMENTS + N_RINGS;

pub(super) const ABOUT: FeatureAbout = FeatureAbout {
    words: "descriptors",
    n_values: |_| N_VALUES,
    prepare: |_, full_scale| Box::new(Descriptors { full_scale }),
};

#[derive(Debug)]
struct Descriptors {
    full_scale: f64,
}

impl Feature for Descriptors {
    fn write(&self, image: &Image, _: &mut FeatureWorkspace, out: &mut [f64]) {
        out.fill(0.0);
        let deepest = image.largest;
        if deepest == 0.0 {
            return;
        }
        let (of_levels, out) = out.split_at_mut(3 + 3 * N_LEVELS);
        let (of_moments, profile) = out.split_at_mut(3 * N_MOMENTS);
        let counts = count_levels(image, self.full_scale / N_LEVELS as f64);
        of_levels[..3].copy_from_slice(&[deepest, image.sum, counts.squares.sqrt()]);
        let levels = of_levels[3..].chunks_exact_mut(N_LEVELS);
        let Counts {
            fixed,
            relative,
            behind,
            ..
        } = counts;
        for (out, counts) in levels.zip([fixed, relative, behind]) {
            areas_above(&counts, out);
        }
        of_levels[3 + 2 * N_LEVELS..].reverse();
        let weights = [
            Weight::Pressure,
            Weight::Touched,
            Weight::Above(0.5 * deepest),
        ];
        of_moments.copy_from_slice(moments(image, weights).as_flattened());
        write_profile(image, profile);
    }
}

/// Numbers of taxels, counted by the highest depth level that they reach; the last level includes all larger values.
#[derive(Default)]
struct Counts {
    fixed: [u32; N_LEVELS],
    relative: [u32; N_LEVELS],
    /// Histogram of the taxels by their distance from the largest value of the image, in steps of the fixed levels; index N_LEVELS − ℓ counts distance ℓ.
    behind: [u32; N_LEVELS],
    /// Sum of the squared values of the image.
    squares: f64,
}

#[multiversion(targets("x86_64+avx2"))]
fn count_levels(image: &Image, step: f64) -> Counts {
    let mut counts = Counts::default();
    let relative_step = image.largest / (N_LEVELS + 1) as f64;
    for value in &image.touched.value {
        counts.squares += value * value;
        count(&mut counts.fixed, (value / step) as i32);
        count(&mut counts.relative, (value / relative_step) as i32);
        let least = ((image.largest - value) / step).ceil() as i32;
        count(&mut counts.behind, N_LEVELS as i32 + 1 - least.max(1));
    }
    counts
}

/// Increments the count of a depth level, counted from 1; the last level includes all higher levels.
#[inline(always)]
fn count(counts: &mut [u32; N_LEVELS], level: i32) {
    if level > 0 {
        counts[(level as usize).min(N_LEVELS) - 1] += 1;
    }
}

/// Writes, for each depth level, the square root of the number of taxels at this level or above.
fn areas_above(counts: &[u32; N_LEVELS], out: &mut [f64]) {
    let mut above = 0;
    for (to, count) in out.iter_mut().zip(counts).rev() {
        above += count;
        *to = f64::from(above).sqrt();
    }
}

/// Writes the mean pressure of each ring around the centroid; parts of a ring beyond the array count as 0.
#[multiversion(targets("x86_64+avx2"))]
fn write_profile(image: &Image, profile: &mut [f64]) {
    let width = 0.5 * image.nx.min(image.ny) as f64 / N_RINGS as f64;
    let (x, y) = image.centroid;
    let Touched {
        x: columns,
        y: rows,
        value,
    } = &image.touched;
    for at in 0..value.len() {
        let (along, across) = (columns[at] - x, rows[at] - y);
        let ring = ((along * along + across * across).sqrt() / width) as i32 as usize;
        if ring < profile.len() {
            profile[ring] += value[at];
        }
    }
    for (ring, sum) in profile.iter_mut().enumerate() {
        let (inner, outer) = (ring as f64 * width, (ring + 1) as f64 * width);
        *sum /= PI * (outer * outer - inner * inner);
    }
}

#[cfg(test)]
mod tests {
    use super::super::ImageFeature;
    use super::super::tests::{features_of, frame};
    use super::*;
    use crate::world::ImageShape;

    fn root_of_count(frame: &[f64], is_counted: impl Fn(f64) -> bool) -> f64 {
        let counted = frame.iter().filter(|&&v| v > 0.0 && is_counted(v));
        (counted.count() as f64).sqrt()
    }

    #[test]
    fn areas_are_counts_of_taxels_above_each_level() {
        let shape = ImageShape { ny: 16, nx: 16 };
        let frame = frame(shape);
        let found = features_of(ImageFeature::Descriptors, shape, &frame);
        assert_eq!(found.len(), N_VALUES);
        let deepest = frame.iter().copied().fold(0.0, f64::max);
        assert_eq!(found[0], deepest);
        // The full scale is 1 in tests.
        for k in 1..=24 {
            let level = k as f64 / 24.0;
            let expected = [
                root_of_count(&frame, |v| v >= level),
                root_of_count(&frame, |v| v >= k as f64 * deepest / 25.0),
                root_of_count(&frame, |v| v >= deepest - level),
            ];
            for (kind, expected) in expected.into_iter().enumerate() {
                assert_eq!(found[2 + kind * 24 + k], expected, "{kind} {k}");
            }
        }
    }

    /// Checks the areas at depth levels below the largest value of the image. A deeper press of a rigid object adds a constant to every touched taxel.
    #[test]
    fn areas_behind_the_foremost_point_do_not_change_with_depth() {
        let shape = ImageShape { ny: 32, nx: 32 };
        let ball = |depth: f64| -> Vec<f64> {
            let away =
                |i: usize| ((i % 32) as f64 - 15.0).powi(2) + ((i / 32) as f64 - 14.0).powi(2);
            (0..1024)
                .map(|i| (depth - away(i) / 301.7).max(0.0))
                .collect()
        };
        let behind = |depth| {
            let found = features_of(ImageFeature::Descriptors, shape, &ball(depth));
            // Levels within the depth of either press.
            found[3 + 48..3 + 48 + 12].to_vec()
        };
        assert_eq!(behind(0.52), behind(0.52 + 0.25));
        assert!(behind(0.52).iter().any(|&area| area > 0.0));
    }
}
