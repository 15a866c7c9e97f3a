//! Velocities at waypoints for smooth cubics between them.

/// Returns the n velocities of the C² cubic spline with zero velocity at both ends. `steps` are the n − 1 durations and `secants` the mean
/// velocities between n values.
///
/// Adjacent pieces have equal accelerations at their common waypoint: `m₋/h₋ + 2 (1/h₋ + 1/h₊) m + m₊/h₊ = 3 (d₋/h₋ + d₊/h₊)`. The symbol h is the duration and
/// d the secant before and after the waypoint. The equations form a tridiagonal system with a dominant diagonal, solved by elimination.
pub(super) fn clamped_spline(steps: &[f64], secants: &[f64]) -> Vec<f64> {
    let n = steps.len() + 1;
    let mut slopes = vec![0.0; n];
    // After elimination: slope = right − above · next slope.
    let mut above = vec![0.0; n];
    for i in 1..n - 1 {
        let (before, after) = (1.0 / steps[i - 1], 1.0 / steps[i]);
        let pivot = 2.0 * (before + after) - before * above[i - 1];
        let right = 3.0 * (secants[i - 1] * before + secants[i] * after);
        above[i] = after / pivot;
        slopes[i] = (right - before * slopes[i - 1]) / pivot;
    }
    for i in (1..n - 1).rev() {
        slopes[i] -= above[i] * slopes[i + 1];
    }
    slopes
}

/// Returns velocities for which no cubic leaves the range of its two values \[FC\]: zero at the ends, [`monotone_slope`] elsewhere.
pub(super) fn monotone(steps: &[f64], secants: &[f64]) -> Vec<f64> {
    let mut slopes = vec![0.0; steps.len() + 1];
    for i in 1..steps.len() {
        slopes[i] = monotone_slope([steps[i - 1], steps[i]], [secants[i - 1], secants[i]]);
    }
    slopes
}

/// Returns the velocity between two pieces: zero at reversals, otherwise the weighted harmonic mean of the adjacent secants (Fritsch and Butland's choice). The
/// mean is at most three times the smaller secant.
pub(super) fn monotone_slope([h0, h1]: [f64; 2], [d0, d1]: [f64; 2]) -> f64 {
    match d0 * d1 > 0.0 {
        true => {
            let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
            (w0 + w1) / (w0 / d0 + w1 / d1)
        }
        false => 0.0,
    }
}
