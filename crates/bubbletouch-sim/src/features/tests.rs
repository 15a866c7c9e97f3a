//! Laws of image features, tested on all features.

use super::*;
use crate::random::Seed;
use crate::world::ImageShape;
use rand::Rng;

pub(super) fn shape(ny: usize, nx: usize) -> ImageShape {
    ImageShape { ny, nx }
}

/// Returns a test frame with an irregular blob with holes in the middle third of an array; values are between 0 and 1.
pub(super) fn frame(ImageShape { ny, nx }: ImageShape) -> Vec<f64> {
    let mut rng = Seed::new(7).named("frame").rng();
    let near = |i: usize, n: usize| 3 * i >= n && 3 * i < 2 * n;
    let value = |i: usize| match near(i % nx, nx) && near(i / nx, ny) {
        true => rng.gen_range(-0.3..1.0_f64).max(0.0),
        false => 0.0,
    };
    (0..ny * nx).map(value).collect()
}

/// Returns the features of a noise-free frame of full scale 1.
pub(super) fn features_of(feature: ImageFeature, shape: ImageShape, frame: &[f64]) -> Vec<f64> {
    let join = Join::new(&[feature]).unwrap();
    written(join, shape, frame, Cut::default())
}

fn written(join: Join, shape: ImageShape, frame: &[f64], cut: Cut) -> Vec<f64> {
    let features = ImageFeatures::new(join, shape, 1.0, cut);
    let mut out = vec![f64::NAN; join.n_values(shape)];
    features.write(frame, &mut FeatureWorkspace::default(), &mut out);
    out
}

/// Returns all features of a frame of which some parts are omitted.
fn all(shape: ImageShape, frame: &[f64], level: f64, foremost: Option<f64>) -> Vec<f64> {
    let join = Join::new(ImageFeature::ALL).unwrap();
    written(join, shape, frame, Cut { level, foremost })
}

/// Returns the frame shifted cyclically by whole taxels.
fn shifted(
    frame: &[f64],
    ImageShape { ny, nx }: ImageShape,
    (up, along): (usize, usize),
) -> Vec<f64> {
    let from = |i: usize| (i / nx + ny - up) % ny * nx + (i % nx + nx - along) % nx;
    (0..ny * nx).map(|i| frame[from(i)]).collect()
}

/// Returns the frame rotated by 90°.
fn turned(frame: &[f64], side: usize) -> Vec<f64> {
    let from = |i: usize| (i % side) * side + side - 1 - i / side;
    (0..side * side).map(|i| frame[from(i)]).collect()
}

fn mirrored(frame: &[f64], nx: usize) -> Vec<f64> {
    let rows = frame.chunks_exact(nx);
    rows.flat_map(|row| row.iter().rev().copied()).collect()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()))
}

/// Tolerance for rounding errors of numbers from 1 to 10, and of square roots of numbers that are 0 except for rounding.
const ROUNDING: f64 = 1e-7;

/// Asserts that exactly the features `same` are equal for two frames.
fn assert_same(grid: ImageShape, a: &[f64], b: &[f64], same: &[ImageFeature]) {
    for feature in ImageFeature::ALL {
        let [before, after] = [a, b].map(|frame| features_of(*feature, grid, frame));
        assert!(before.iter().any(|&value| value > 0.1), "{feature:?}");
        let difference = largest_difference(&before, &after);
        let is_same = difference < ROUNDING;
        assert_eq!(is_same, same.contains(feature), "{feature:?}: {difference}");
    }
}

#[test]
fn a_shift_on_the_array_changes_no_feature_and_one_around_the_edge_no_fourier_magnitude() {
    for grid in [(30, 30), (24, 36), (31, 27)].map(|(ny, nx)| shape(ny, nx)) {
        let frame = frame(grid);
        for by in [(0, 1), (3, 0), (5, 7)] {
            assert_same(grid, &frame, &shifted(&frame, grid, by), ImageFeature::ALL);
        }
    }
    let grid = shape(24, 24);
    let (frame, cyclic) = (
        frame(grid),
        [ImageFeature::FourierMagnitude, ImageFeature::FourierMellin],
    );
    assert_same(grid, &frame, &shifted(&frame, grid, (12, 5)), &cyclic);
}

#[test]
fn a_quarter_turn_changes_none_but_the_fourier_magnitude() {
    for side in [24, 31] {
        let frame = frame(shape(side, side));
        let turned = turned(&frame, side);
        assert_same(shape(side, side), &frame, &turned, &ImageFeature::ALL[1..]);
    }
}

#[test]
fn a_mirror_image_has_the_same_harmonics_and_the_descriptors_but_three() {
    let grid = shape(24, 24);
    let frame = frame(grid);
    let mirrored = mirrored(&frame, 24);
    for (feature, n_changed) in [
        (ImageFeature::FourierMellin, 0),
        (ImageFeature::PolarHarmonics, 0),
        (ImageFeature::Descriptors, 3),
    ] {
        let [before, after] = [&frame, &mirrored].map(|frame| features_of(feature, grid, frame));
        let pairs = before.iter().zip(&after);
        let changed: Vec<_> = pairs.filter(|(a, b)| (*a - *b).abs() > ROUNDING).collect();
        assert_eq!(changed.len(), n_changed, "{feature:?}");
        assert!(changed.iter().all(|(a, b)| (*a + *b).abs() < ROUNDING));
    }
}

#[test]
fn more_pressure_multiplies_roots_and_the_aligned_image() {
    let grid = shape(20, 20);
    let frame = frame(grid);
    let more: Vec<f64> = frame.iter().map(|value| 4.0 * value).collect();
    for (feature, factor) in [
        (ImageFeature::FourierMagnitude, 2.0),
        (ImageFeature::FourierMellin, 2.0),
        (ImageFeature::PolarHarmonics, 2.0),
        (ImageFeature::Aligned, 4.0),
    ] {
        let found = features_of(feature, grid, &frame);
        let scaled: Vec<f64> = found.iter().map(|value| factor * value).collect();
        let difference = largest_difference(&scaled, &features_of(feature, grid, &more));
        assert!(difference < ROUNDING, "{feature:?}: {difference}");
    }
}

#[test]
fn what_is_below_the_level_counts_as_nothing() {
    let grid = shape(18, 21);
    let frame = frame(grid);
    let changed = |below: &dyn Fn(usize) -> f64| -> Vec<f64> {
        let values = frame.iter().enumerate();
        let value = |(i, &value)| if value >= 0.4 { value } else { below(i) };
        values.map(value).collect()
    };
    let of_above = all(grid, &changed(&|_| 0.0), 0.0, None);
    let noisy = changed(&|i| [-3.0, 0.39, f64::NAN][i % 3]);
    assert!(all(grid, &noisy, 0.4, None) == of_above);
    assert!(all(grid, &frame, 0.0, None) != of_above);
}

#[test]
fn nothing_has_no_features_and_any_array_has_finite_ones() {
    for grid in [(1, 1), (1, 5), (5, 1), (2, 2), (3, 3), (7, 4)].map(|(ny, nx)| shape(ny, nx)) {
        let of = |value: &dyn Fn(usize) -> f64| {
            let frame: Vec<f64> = (0..grid.n_values()).map(value).collect();
            all(grid, &frame, 0.0, None)
        };
        assert!(of(&|_| 0.0).iter().all(|&v| v == 0.0));
        for found in [of(&|_| 0.5), of(&|i| i as f64), of(&|_| 1e100)] {
            assert!(found.iter().all(|v| !v.is_nan()), "{grid:?}");
        }
    }
}

#[test]
fn a_join_is_its_features_one_after_the_other_in_whatever_order_it_is_written() {
    let grid = shape(16, 16);
    let frame = frame(grid);
    let features = Features::try_from("descriptors + fourier_mellin".to_owned()).unwrap();
    assert_eq!(String::from(features), "fourier_mellin+descriptors");
    let parts = [ImageFeature::FourierMellin, ImageFeature::Descriptors];
    let expected = parts
        .map(|feature| features_of(feature, grid, &frame))
        .concat();
    let join = features.of_image().unwrap();
    assert_eq!(features.n_values(3, grid), expected.len());
    assert_eq!(written(join, grid, &frame, Cut::default()), expected);
}

#[test]
fn every_name_reads_back_and_others_are_told_what_there_is() {
    for name in [
        "raw",
        "centred",
        "unit_norm",
        "centred_unit_norm",
        "aligned",
    ] {
        let features = Features::try_from(name.to_owned()).unwrap();
        assert_eq!(String::from(features), name);
    }
    for (given, wanted) in [
        ("fourier", "fourier_mellin"),
        ("", "raw"),
        ("raw+aligned", "joined by +"),
        ("aligned+", "joined by +"),
        ("aligned+aligned", "each once"),
    ] {
        let error = Features::try_from(given.to_owned())
            .unwrap_err()
            .to_string();
        assert!(error.contains(wanted), "{error}");
    }
}

/// Checks that images with a depth window do not change if the press becomes deeper. A deeper press of a rigid object adds a constant to every touched taxel,
/// and touches more taxels.
#[test]
fn what_is_behind_the_foremost_point_does_not_change_with_depth() {
    let grid = shape(32, 32);
    let pressed = |depth: f64| -> Vec<f64> {
        let away = |i: usize| ((i % 32) as f64 - 15.0).powi(2) + ((i / 32) as f64 - 14.0).powi(2);
        let surface = |i: usize| away(i) / 301.7 + 0.02 * ((i % 7) as f64).sin().abs();
        (0..1024).map(|i| (depth - surface(i)).max(0.0)).collect()
    };
    let found = |depth, foremost| all(grid, &pressed(depth), 0.0, foremost);
    let [shallow, deep] = [0.4, 0.75].map(|depth| found(depth, Some(0.3)));
    assert!(largest_difference(&shallow, &deep) < ROUNDING);
    let [shallow, deep] = [0.4, 0.75].map(|depth| found(depth, None));
    assert!(largest_difference(&shallow, &deep) > 1.0);
    // A press that is less deep than the window is unchanged.
    assert!(found(0.2, Some(0.3)) == found(0.2, None));
}
