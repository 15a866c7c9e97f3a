//! Resampling of recorded touches to another number of frames.

use ndarray::{ArrayView2, ArrayViewMut2};

/// Returns the instant of a frame of a resampled touch, in frames of the recorded touch. The instants are evenly spaced from the first to the last recorded
/// frame; a single frame is the last one.
pub fn resampled_instant(frame: usize, n_resampled: usize, n_recorded: usize) -> f64 {
    let last = (n_recorded - 1) as f64;
    match n_resampled {
        1 => last,
        _ => frame as f64 * last / (n_resampled - 1) as f64,
    }
}

/// Resamples a touch by linear interpolation. `recorded` has the frames of the touch, shape (n_recorded, n_values), and `resampled` has the shape
/// (n_resampled, n_values).
///
/// # Panics
/// If the touch has no frames, or the numbers of values differ.
pub fn resample(recorded: ArrayView2<f64>, mut resampled: ArrayViewMut2<f64>) {
    let n = [resampled.nrows(), recorded.nrows()];
    for (frame, mut out) in resampled.outer_iter_mut().enumerate() {
        let at = resampled_instant(frame, n[0], n[1]);
        let (before, part) = (at.floor() as usize, at.fract());
        out.assign(&recorded.row(before));
        if part > 0.0 {
            let after = recorded.row(before + 1);
            out.zip_mut_with(&after, |out, after| *out += part * (after - *out));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{Array2, s};

    #[test]
    fn a_course_that_is_linear_in_time_stays_the_same() {
        for (n_recorded, n_resampled) in [(1, 1), (1, 4), (5, 1), (5, 2), (5, 5), (5, 9), (7, 4)] {
            let end = (n_recorded - 1).max(1) as f64;
            let course = |at: f64| [2.0 - at, 3.0 * at, -1.0];
            let recorded =
                Array2::from_shape_fn((n_recorded, 3), |(t, k)| course(t as f64 / end)[k]);
            let mut found = Array2::from_elem((n_resampled, 3), f64::NAN);
            resample(recorded.view(), found.view_mut());
            for (frame, values) in found.outer_iter().enumerate() {
                let at = resampled_instant(frame, n_resampled, n_recorded) / end;
                for (value, expected) in values.iter().zip(course(at)) {
                    assert!(
                        (value - expected).abs() < 1e-12,
                        "{n_recorded} {n_resampled} {frame}"
                    );
                }
            }
            // The first and the last frame are recorded frames.
            let last = found.slice(s![-1, ..]);
            assert_eq!(last, recorded.slice(s![-1, ..]));
            if n_resampled > 1 {
                assert_eq!(found.row(0), recorded.row(0));
            }
        }
    }
}
