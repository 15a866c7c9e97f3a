//! Prediction of a frame after a small additional tilt of the object.
//!
//! The deflection at (x, y) under a rigid object is the height of its surface below the untouched skin. A small tilt adds a plane to it, δ + a x + b y, except
//! for second-order terms in the angle (1 − cos 5° = 0.004). The patch then moves until the foremost point has its previous depth:
//!
//! δ'(x, y) = max(0, δ + a x + b y − max(δ + a x + b y) + max δ), where each maximum is over the touched taxels.
//!
//! Untouched taxels stay untouched, since a frame does not contain their distance to the object. If the tilt would bring
//! them into contact, the image still ends at its old border.

/// Writes the frame of ny × nx values (row after row) that would be measured on a tilted object. `slope` is (a, b), the increase of the value per column and
/// per row in the unit of the frame. Values below `level` count as untouched.
///
/// # Panics
/// If `out` and the frame differ in length, or if the frame does not consist of whole rows.
pub fn tilt_frame(frame: &[f64], nx: usize, slope: (f64, f64), level: f64, out: &mut [f64]) {
    assert!(nx > 0 && frame.len().is_multiple_of(nx), "whole rows");
    assert_eq!(frame.len(), out.len(), "values of a frame");
    let least = level.max(f64::MIN_POSITIVE);
    let (mut deepest, mut foremost) = (0.0_f64, f64::NEG_INFINITY);
    let rows = frame.chunks_exact(nx).zip(out.chunks_exact_mut(nx));
    for (y, (row, out)) in rows.enumerate() {
        for (x, (&value, out)) in row.iter().zip(out).enumerate() {
            *out = f64::NEG_INFINITY;
            if value >= least {
                *out = value + slope.0 * x as f64 + slope.1 * y as f64;
                deepest = deepest.max(value);
                foremost = foremost.max(*out);
            }
        }
    }
    for out in out {
        *out = match *out > f64::NEG_INFINITY {
            true => (*out - foremost + deepest).max(0.0),
            false => 0.0,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NX: usize = 40;

    /// Returns the depth of a surface at each position, pressed so that its foremost point has depth 1.
    fn pressed(height: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let at = |i: usize| height((i % NX) as f64 - 19.5, (i / NX) as f64 - 14.5);
        let heights: Vec<f64> = (0..NX * 30).map(at).collect();
        let foremost = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let deep = heights.iter().map(|h| (h - foremost + 1.0).max(0.0));
        deep.collect()
    }

    fn tilted(frame: &[f64], slope: (f64, f64)) -> Vec<f64> {
        let mut out = vec![f64::NAN; frame.len()];
        tilt_frame(frame, NX, slope, 0.0, &mut out);
        out
    }

    /// Compares a tilted copy with the frame of the tilted surface where both are touched. The two frames are equal up to an offset. The offset is 0 if the
    /// foremost point of the tilted surface was already touched before the tilt.
    #[test]
    fn a_copy_is_the_frame_of_the_tilted_surface_where_that_was_touched() {
        let ball = |x: f64, y: f64| -(x * x + y * y) / 200.0;
        let saddle = |x: f64, y: f64| x * x / 900.0 - y * y / 150.0 - (x * x / 300.0).powi(2);
        let shapes: [&dyn Fn(f64, f64) -> f64; 2] = [&ball, &saddle];
        for height in shapes {
            for slope in [(0.03, 0.0), (-0.02, 0.04)] {
                let flat = pressed(height);
                let truth = pressed(|x, y| height(x, y) + slope.0 * x + slope.1 * y);
                let copy = tilted(&flat, slope);
                let mut n_touched = 0;
                for ((copy, truth), flat) in copy.iter().zip(&truth).zip(&flat) {
                    let expected = if *flat > 0.0 { *truth } else { 0.0 };
                    assert!((copy - expected).abs() < 1e-12, "{copy} {expected}");
                    n_touched += usize::from(*copy > 0.0);
                }
                assert!(n_touched > 100);
                assert_ne!(copy, flat);
            }
        }
    }

    #[test]
    fn a_copy_is_as_deep_as_its_frame_and_no_tilt_changes_nothing_but_noise() {
        let mut frame = pressed(|x, y| -(x.abs() + 0.5 * y.abs()) / 12.0);
        assert_eq!(tilted(&frame, (0.0, 0.0)), frame);
        let deepest = |frame: &[f64]| frame.iter().copied().fold(0.0, f64::max);
        let copy = tilted(&frame, (0.05, -0.03));
        assert!((deepest(&copy) - deepest(&frame)).abs() < 1e-15);
        // Noise on untouched taxels is not contact, and an empty frame stays empty.
        frame[0] = 0.01;
        let mut out = vec![0.0; frame.len()];
        tilt_frame(&frame, NX, (0.1, 0.0), 0.02, &mut out);
        assert_eq!(out[0], 0.0);
        assert_eq!(
            tilted(&vec![0.0; frame.len()], (0.1, 0.1)),
            vec![0.0; frame.len()]
        );
    }
}
