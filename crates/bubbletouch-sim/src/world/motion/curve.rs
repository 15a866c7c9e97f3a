//! One coordinate over time: a cubic polynomial between adjacent waypoints.

use super::slopes::{clamped_spline, monotone};
use serde::{Deserialize, Serialize};

/// Interpolation between waypoints of a trajectory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// Piecewise linear: constant velocity, with a jump of the velocity at each waypoint.
    Linear,
    /// Cubic spline with continuous acceleration and zero velocity at its first and last waypoint; it may overshoot its waypoints.
    #[default]
    Cubic,
    /// Cubic polynomials with continuous velocity that never leave the range of their two waypoints. The velocity is zero at the first and last waypoint and
    /// at reversals.
    Monotone,
}

/// One coordinate as a function of time. The owner stores the times of the waypoints, which several curves share.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    /// Coefficients c of each piece between two waypoints. The value is `x = c₀ + c₁ s + c₂ s² + c₃ s³`, with s in seconds after the piece's first waypoint.
    pieces: Vec<[f64; 4]>,
    /// Value of the curve at the last waypoint.
    last: f64,
}

/// Value of a curve or of its velocity, with the time at which this value occurs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Taken {
    pub value: f64,
    /// Time at which the value occurs, seconds, counted as in the times of the waypoints.
    pub time: f64,
    /// Index of the waypoint before this time.
    pub piece: usize,
}

/// Smallest and largest value, and largest velocity, of a curve over its whole duration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extremes {
    pub lowest: Taken,
    pub highest: Taken,
    /// Velocity with the largest magnitude, including its sign.
    pub fastest: Taken,
}

impl Curve {
    /// Creates the curve through `values` at `times` (at least one each, times ascending). Returns `None` if a coefficient is not finite, because the
    /// waypoints are too far apart in value or too close in time.
    pub fn through(times: &[f64], values: &[f64], interpolation: Interpolation) -> Option<Self> {
        let steps: Vec<f64> = times.windows(2).map(|t| t[1] - t[0]).collect();
        let rises = values.windows(2).map(|x| x[1] - x[0]);
        let secants: Vec<f64> = rises.zip(&steps).map(|(dx, dt)| dx / dt).collect();
        let slopes = match interpolation {
            Interpolation::Linear => None,
            Interpolation::Cubic => Some(clamped_spline(&steps, &secants)),
            Interpolation::Monotone => Some(monotone(&steps, &secants)),
        };
        let piece = |i: usize| match &slopes {
            None => [values[i], secants[i], 0.0, 0.0],
            Some(slopes) => {
                let (m0, m1, d, h) = (slopes[i], slopes[i + 1], secants[i], steps[i]);
                let c2 = (3.0 * d - 2.0 * m0 - m1) / h;
                [values[i], m0, c2, (m0 + m1 - 2.0 * d) / h / h]
            }
        };
        let pieces: Vec<[f64; 4]> = (0..steps.len()).map(piece).collect();
        let is_finite = pieces.iter().flatten().all(|c| c.is_finite());
        is_finite.then_some(Self {
            pieces,
            last: values[values.len() - 1],
        })
    }

    /// Returns the value of the curve at a moment.
    pub fn value(&self, at: Moment) -> f64 {
        match at {
            Moment::In { piece, elapsed } => value(&self.pieces[piece], elapsed),
            Moment::Before => self.pieces.first().map_or(self.last, |c| c[0]),
            Moment::After => self.last,
        }
    }

    /// Returns the velocity of the curve, per second; 0 before the first and after the last waypoint.
    pub fn velocity(&self, at: Moment) -> f64 {
        match at {
            Moment::In { piece, elapsed } => velocity(&self.pieces[piece], elapsed),
            Moment::Before | Moment::After => 0.0,
        }
    }

    /// Returns the extremes of the curve in closed form. Extremes of the value occur at waypoints and where the velocity is zero. Extremes of the velocity
    /// occur at waypoints and where the acceleration is zero.
    pub fn extremes(&self, times: &[f64]) -> Extremes {
        let end = Taken {
            value: self.last,
            time: times[times.len() - 1],
            piece: times.len() - 1,
        };
        let mut found = Extremes {
            lowest: end,
            highest: end,
            fastest: Taken { value: 0.0, ..end },
        };
        for (piece, c) in self.pieces.iter().enumerate() {
            let h = times[piece + 1] - times[piece];
            let taken = |value, s| Taken {
                value,
                time: times[piece] + s,
                piece,
            };
            let turns = quadratic_roots(3.0 * c[3], 2.0 * c[2], c[1]);
            let is_inside = |s: &f64| (0.0..h).contains(s);
            for s in turns.into_iter().filter(is_inside).chain([0.0]) {
                found.keep_position(taken(value(c, s), s));
            }
            let bend = -c[2] / (3.0 * c[3]);
            for s in [bend].into_iter().filter(is_inside).chain([0.0, h]) {
                found.keep_velocity(taken(velocity(c, s), s));
            }
        }
        found
    }
}

impl Extremes {
    fn keep_position(&mut self, at: Taken) {
        if at.value < self.lowest.value {
            self.lowest = at;
        }
        if at.value > self.highest.value {
            self.highest = at;
        }
    }

    fn keep_velocity(&mut self, at: Taken) {
        if at.value.abs() > self.fastest.value.abs() {
            self.fastest = at;
        }
    }
}

/// Position of a time among the waypoints of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Moment {
    /// Before the first waypoint.
    Before,
    /// Between two waypoints, `elapsed` seconds after the first of them.
    In { piece: usize, elapsed: f64 },
    /// At or after the last waypoint.
    After,
}

impl Moment {
    /// Locates a time in seconds among the waypoints; NaN counts as before the first waypoint.
    pub fn new(time: f64, times: &[f64]) -> Self {
        let passed = times.partition_point(|&way_point| way_point <= time);
        match passed {
            0 => Self::Before,
            n if n == times.len() => Self::After,
            n => Self::In {
                piece: n - 1,
                elapsed: time - times[n - 1],
            },
        }
    }
}

fn value(c: &[f64; 4], s: f64) -> f64 {
    c[0] + s * (c[1] + s * (c[2] + s * c[3]))
}

fn velocity(c: &[f64; 4], s: f64) -> f64 {
    c[1] + s * (2.0 * c[2] + s * 3.0 * c[3])
}

/// Returns the two real roots of `a s² + b s + c`, computed without cancellation; NaN for missing roots.
fn quadratic_roots(a: f64, b: f64, c: f64) -> [f64; 2] {
    let q = -0.5 * (b + (b * b - 4.0 * a * c).sqrt().copysign(b));
    [q / a, c / q]
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMES: [f64; 5] = [0.0, 0.5, 1.7, 2.0, 4.0];
    const VALUES: [f64; 5] = [0.0, 1.0, 1.2, -0.7, -0.7];
    const KINDS: [Interpolation; 3] = [
        Interpolation::Linear,
        Interpolation::Cubic,
        Interpolation::Monotone,
    ];

    fn curve(interpolation: Interpolation) -> Curve {
        Curve::through(&TIMES, &VALUES, interpolation).expect("tame numbers")
    }

    /// Returns value, velocity and acceleration of a curve immediately before and after an inner waypoint.
    fn sides(curve: &Curve, piece: usize) -> [[f64; 3]; 2] {
        let h = TIMES[piece + 1] - TIMES[piece];
        [(piece, h), (piece + 1, 0.0)].map(|(piece, s)| {
            let c = &curve.pieces[piece];
            [value(c, s), velocity(c, s), 2.0 * c[2] + 6.0 * c[3] * s]
        })
    }

    #[test]
    fn each_interpolation_is_as_smooth_as_it_says() {
        for (kind, n_continuous) in KINDS.into_iter().zip([1, 3, 2]) {
            let curve = curve(kind);
            for piece in 0..3 {
                let [before, after] = sides(&curve, piece);
                for k in 0..n_continuous {
                    let jump = (before[k] - after[k]).abs();
                    assert!(jump < 1e-12, "{kind:?}, {piece}, {k}");
                }
            }
        }
    }

    #[test]
    fn extremes_are_those_of_a_fine_search() {
        for kind in KINDS {
            let curve = curve(kind);
            let found = curve.extremes(&TIMES);
            let samples: Vec<Moment> = (0..400_000)
                .map(|i| Moment::new(1e-5 * f64::from(i), &TIMES))
                .collect();
            let values = samples.iter().map(|&at| curve.value(at));
            let lowest = values.clone().fold(f64::INFINITY, f64::min);
            let highest = values.fold(f64::NEG_INFINITY, f64::max);
            let speeds = samples.iter().map(|&at| curve.velocity(at).abs());
            let fastest = speeds.fold(0.0, f64::max);
            for (found, expected, tolerance) in [
                (found.lowest.value, lowest, 1e-8),
                (found.highest.value, highest, 1e-8),
                (found.fastest.value.abs(), fastest, 1e-4),
            ] {
                let error = (found - expected).abs();
                assert!(error < tolerance, "{kind:?}: {found}, {expected}");
            }
            let at = Moment::new(found.highest.time, &TIMES);
            assert!((curve.value(at) - found.highest.value).abs() < 1e-12);
        }
    }

    #[test]
    fn way_points_that_are_too_steep_make_no_curve() {
        for kind in KINDS {
            assert_eq!(Curve::through(&[0.0, 1e-300], &[0.0, 1e10], kind), None);
        }
    }
}
