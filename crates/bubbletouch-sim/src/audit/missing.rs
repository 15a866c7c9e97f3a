//! Missing readings: NaN and infinite numbers.

use crate::statistics::quantile::quantile;
use ndarray::{Array2, ArrayView2};

/// Returns the number of readings of each taxel that are NaN or infinite.
pub fn count_missing(frames: ArrayView2<f64>) -> Vec<usize> {
    let mut counts = vec![0; frames.ncols()];
    for frame in frames.rows() {
        for (count, reading) in counts.iter_mut().zip(frame) {
            *count += usize::from(!reading.is_finite());
        }
    }
    counts
}

/// Replaces the padding of touches of unequal length, and returns the number of padded frames of each touch. Padded frames are the frames after the last frame
/// with a reading; frames of a touch without any reading are not padding. `frames` has the shape (n_touches · n_frames, n_taxels).
///
/// Padded frames become the frames of the touch in reverse order and then forward again, so that levels and noise are those of the touch.
pub fn fill_padding(frames: &mut Array2<f64>, n_frames: usize) -> Vec<usize> {
    let n_touches = frames.nrows() / n_frames.max(1);
    let mut n_padded = vec![0; n_touches];
    for (touch, n_padded) in n_padded.iter_mut().enumerate() {
        let first = touch * n_frames;
        let has_reading = |frame: &usize| frames.row(first + frame).iter().any(|x| x.is_finite());
        let Some(last) = (0..n_frames).rev().find(has_reading) else {
            continue;
        };
        *n_padded = n_frames - 1 - last;
        for frame in last + 1..n_frames {
            let place = frame % (2 * last).max(1);
            let source = place.min(2 * last - place.min(2 * last));
            let copy = frames.row(first + source).to_owned();
            frames.row_mut(first + frame).assign(&copy);
        }
    }
    n_padded
}

/// Replaces missing readings by the median of the taxel's other readings; by 0 if the taxel has no readings. `counts` are the numbers of missing readings of
/// each taxel.
pub fn fill_missing(frames: &mut Array2<f64>, counts: &[usize]) {
    for (taxel, _) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let mut column = frames.column_mut(taxel);
        let mut known: Vec<f64> = column.iter().copied().filter(|x| x.is_finite()).collect();
        let median = quantile(&mut known, 0.5);
        column.mapv_inplace(|x| if x.is_finite() { x } else { median });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn padding_becomes_the_frames_of_the_touch_in_reverse_order() {
        let nan = f64::NAN;
        // A touch of three frames with a missing reading, a touch of one frame, a touch without readings and a complete touch.
        let mut frames = array![
            [1.0, 10.0],
            [2.0, nan],
            [3.0, 30.0],
            [nan, nan],
            [nan, nan],
            [nan, nan],
            [7.0, 8.0],
            [nan, nan],
            [nan, nan],
            [nan, nan],
            [nan, nan],
            [nan, nan],
            [nan, nan],
            [nan, nan],
            [nan, nan],
            [nan, nan],
            [nan, nan],
            [nan, nan],
            [1.0, 1.0],
            [2.0, 1.0],
            [nan, nan],
            [4.0, 1.0],
            [5.0, 1.0],
            [6.0, 1.0],
        ];
        assert_eq!(fill_padding(&mut frames, 6), [3, 5, 0, 0]);
        assert_eq!(
            frames.column(0).to_vec()[..12],
            [1.0, 2.0, 3.0, 2.0, 1.0, 2.0, 7.0, 7.0, 7.0, 7.0, 7.0, 7.0]
        );
        assert!(frames[(3, 1)].is_nan() && frames[(12, 0)].is_nan() && frames[(20, 0)].is_nan());
    }
}
