//! Logarithmic spectra of touches of many frames: a representation that does not depend on the phase of a vibration.

use ndarray::{Array2, ArrayView2, s};
use std::f64::consts::{PI, TAU};

/// Number of frames of a segment whose spectra are averaged; a longer touch has several segments.
const SEGMENT: usize = 256;
/// Maximum number of bands of equal width.
const MAX_BANDS: usize = 32;

/// Returns the logarithm of the mean power of each band of frequencies, taxel and touch, shape (n_touches, n_taxels · n_bands). `frames` has the shape (n_touches ·
/// n_frames, n_taxels). Returns `None` for fewer than 16 frames of a touch.
pub fn log_spectra(frames: ArrayView2<f64>, n_frames: usize) -> Option<Array2<f64>> {
    if n_frames < MAX_BANDS / 2 {
        return None;
    }
    let segment = n_frames.min(SEGMENT);
    let (n_segments, n_lines) = (n_frames / segment, segment / 2);
    let n_bands = n_lines.min(MAX_BANDS);
    let n_touches = frames.nrows() / n_frames;
    let window = |frame: usize| (PI * (frame as f64 + 0.5) / segment as f64).sin().powi(2);
    let wave = |phase: f64| {
        Array2::from_shape_fn((n_lines, segment), |(line, frame)| {
            let turns = (line + 1) as f64 * frame as f64 / segment as f64;
            window(frame) * (TAU * turns + phase).cos()
        })
    };
    let waves = [wave(0.0), wave(PI / 2.0)];
    let n_taxels = frames.ncols();
    let mut spectra = Array2::zeros((n_touches, n_taxels * n_bands));
    for touch in 0..n_touches {
        let mut power = Array2::<f64>::zeros((n_lines, n_taxels));
        for start in (0..n_segments).map(|k| touch * n_frames + k * segment) {
            let mut own = frames.slice(s![start..start + segment, ..]).to_owned();
            for mut column in own.columns_mut() {
                let mean = column.mean().unwrap_or(0.0);
                column -= mean;
            }
            for waves in &waves {
                power += &waves.dot(&own).mapv(|x| x * x);
            }
        }
        for band in 0..n_bands {
            let lines = band * n_lines / n_bands..(band + 1) * n_lines / n_bands;
            let width = lines.len() as f64;
            for taxel in 0..n_taxels {
                let sum = power.slice(s![lines.clone(), taxel]).sum();
                spectra[(touch, taxel * n_bands + band)] = sum / width;
            }
        }
    }
    // Power below a millionth of the mean is noise of the arithmetic.
    let least = 1e-6 * spectra.mean().unwrap_or(0.0) + f64::MIN_POSITIVE;
    Some(spectra.mapv(|power: f64| (power + least).ln()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_band_of_a_vibration_has_the_largest_power_at_any_phase() {
        let frames = Array2::from_shape_fn((2 * 128, 1), |(frame, _)| {
            let phase = if frame < 128 { 0.3 } else { 2.0 };
            (TAU * 20.0 * frame as f64 / 128.0 + phase).sin()
        });
        let found = log_spectra(frames.view(), 128).unwrap();
        // 64 lines in 32 bands: line 20 is in band 9.
        for row in found.rows() {
            let largest = row.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            assert_eq!(row.iter().position(|&x| x == largest), Some(9));
        }
        assert!((found[(0, 9)] - found[(1, 9)]).abs() < 0.01);
    }
}
