//! Velocities at waypoints for smooth cubics between them.

/// Returns the velocities at n waypoints for a cubic spline with continuous acceleration and zero velocity at both ends. `steps` are the n − 1 durations, and
/// `secants` the mean velocities between the waypoints.
///
/// Adjacent pieces have equal accelerations at their common waypoint: `m₋/h₋ + 2 (1/h₋ + 1/h₊) m + m₊/h₊ = 3 (d₋/h₋ + d₊/h₊)`. The symbols h₋ and h₊ are the
/// durations, and d₋ and d₊ the mean velocities, before and after the waypoint. The velocities at three waypoints are m₋, m and m₊. The equations form a
/// tridiagonal system with a dominant diagonal, solved by elimination.
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

/// Returns velocities at the waypoints for which no cubic piece leaves the range of its two values \[FC\]: zero at the ends, [`monotone_slope`] elsewhere.
pub(super) fn monotone(steps: &[f64], secants: &[f64]) -> Vec<f64> {
    let mut slopes = vec![0.0; steps.len() + 1];
    for i in 1..steps.len() {
        slopes[i] = monotone_slope([steps[i - 1], steps[i]], [secants[i - 1], secants[i]]);
    }
    slopes
}

/// Returns the velocity at the waypoint between two pieces of durations `h0`, `h1` and mean velocities `d0`, `d1`. The velocity is zero at reversals,
/// otherwise the weighted harmonic mean of the mean velocities (Fritsch and Butland's choice). The result is at most three times the smaller mean velocity.
pub(super) fn monotone_slope([h0, h1]: [f64; 2], [d0, d1]: [f64; 2]) -> f64 {
    match d0 * d1 > 0.0 {
        true => {
            let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
            (w0 + w1) / (w0 / d0 + w1 / d1)
        }
        false => 0.0,
    }
}
