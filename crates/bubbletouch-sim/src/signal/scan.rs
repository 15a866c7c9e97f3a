//! Scan order: taxels are read one after another while the press continues.
//!
//! Taxels are read row after row. Taxel i of n is read τᵢ = T i/n after the first one, T the scan time of the
//! array. A frame that begins at time t contains xᵢ(t + τᵢ): taxels that are read later are pressed deeper.
//! Between the frames of a touch the values are interpolated linearly. After the last frame the press is at rest. The last frame
//! of a touch, and a touch of a single frame, are therefore unchanged. A touch whose press stops at each depth is also unchanged.

use super::sensor_error::{Effect, ErrorAbout, Strength, TouchRead};

/// Scan of an array: the taxels are read one after another within a given duration.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scan {
    seconds: f64,
}

impl Scan {
    /// Replaces frames of simultaneous values by the readings of a scan, in place. The frames have n_taxels values each and are `interval` seconds apart.
    ///
    /// # Panics
    /// If `n_taxels` is zero or a frame is incomplete.
    fn read_late(&self, frames: &mut [f64], n_taxels: usize, interval: f64) {
        assert!(
            frames.len().is_multiple_of(n_taxels),
            "one value for each taxel"
        );
        let last = frames.len() / n_taxels - 1;
        for taxel in 0..n_taxels {
            let late = self.seconds / interval * taxel as f64 / n_taxels as f64;
            // Each frame is computed from itself and later frames, which still contain the true values.
            for frame in 0..last {
                let time = (frame as f64 + late).min(last as f64);
                let before = (time as usize).min(last - 1);
                let part = time - before as f64;
                let felt = |frame: usize| frames[frame * n_taxels + taxel];
                let (a, b) = (felt(before), felt(before + 1));
                frames[frame * n_taxels + taxel] = a + part * (b - a);
            }
        }
    }
}

/// Seconds in a millisecond.
const MS: f64 = 1e-3;

pub(super) const ABOUT: ErrorAbout = ErrorAbout {
    needs_motion: true,
    ..ErrorAbout::new(
        "scan",
        &[Strength {
            unit: "ms",
            ..Strength::share(
                "scan_time_ms",
                "scan time",
                "zero or a positive number of milliseconds",
            )
        }],
        |&[time_ms, _], _| {
            let seconds = time_ms * MS;
            Ok(Box::new(Scan { seconds }))
        },
    )
};

impl Effect for Scan {
    fn apply(&self, frames: &mut [f64], touch: &TouchRead, _: &mut [f64]) {
        if let Some(interval) = touch.interval {
            self.read_late(frames, touch.n_taxels, interval);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scanned(frames: &[f64], n_taxels: usize, seconds: f64, interval: f64) -> Vec<f64> {
        let mut out = frames.to_vec();
        Scan { seconds }.read_late(&mut out, n_taxels, interval);
        out
    }

    #[test]
    fn a_taxel_that_is_read_later_sees_a_steady_press_deeper() {
        let n = 10;
        let frames: Vec<f64> = (0..4 * n).map(|i| (i / n) as f64).collect();
        let out = scanned(&frames, n, 0.02, 0.05);
        for (place, value) in out.iter().enumerate() {
            let (frame, taxel) = (place / n, place % n);
            // The press moves one unit in 50 ms, taxel i is read 2 i ms late, and the press is at rest from frame 3 on.
            let expected = frame as f64 + if frame < 3 { 0.04 * taxel as f64 } else { 0.0 };
            assert!(
                (value - expected).abs() < 1e-14,
                "{frame}, {taxel}: {value}"
            );
        }
    }

    #[test]
    fn a_scan_slower_than_the_press_sees_frames_that_are_still_to_come_and_then_the_press_at_rest()
    {
        let frames = [0.0, 0.0, 1.0, 1.0, 4.0, 4.0];
        // The second of two taxels is read 1.5 intervals late.
        let out = scanned(&frames, 2, 3.0, 1.0);
        assert_eq!(out, [0.0, 2.5, 1.0, 4.0, 4.0, 4.0]);
    }

    #[test]
    fn one_frame_a_press_at_rest_and_a_scan_of_no_time_stay_as_they_are() {
        let frame = [0.3, 0.1, 0.7];
        assert_eq!(scanned(&frame, 3, 10.0, 1.0), frame);
        assert_eq!(
            scanned(&[frame, frame].concat(), 3, 0.4, 1.0),
            [frame, frame].concat()
        );
        let moving = [frame, [0.9, 0.8, 0.7]].concat();
        assert_eq!(scanned(&moving, 3, 0.0, 1.0), moving);
        assert_eq!(scanned(&moving, 3, 10.0, f64::INFINITY), moving);
    }
}
