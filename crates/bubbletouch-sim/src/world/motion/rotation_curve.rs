//! Rotation over time, interpolated through waypoints.

use super::curve::{Interpolation, Moment};
use super::slopes::monotone_slope;
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

/// Rotation as a smooth function of time, given by pieces between waypoints. Between two waypoints, with s from 0 to 1,
///
/// `R(s) = R₀ exp(ω₁ b₁(s)) exp(ω₂ b₂(s)) exp(ω₃ b₃(s))`, `b = (1 − (1−s)³, 3s² − 2s³, s³)`
///
/// \[KKS\]: a cubic for rotations, whose angular velocity is 3 ω₁ / h at the start and 3 ω₃ / h at the end. If ω₁, ω₂ and ω₃ are equal, the curve is
/// spherical linear interpolation (slerp).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RotationCurve {
    segments: Vec<CurveSegment>,
    last: DQuat,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct CurveSegment {
    start: DQuat,
    /// Rotation vectors of the three control turns whose product is the rotation from start to end, in the body's frame, radians.
    turns: [DVec3; 3],
    /// Duration of the piece between two waypoints, seconds.
    duration: f64,
}

impl RotationCurve {
    /// Creates the curve through unit quaternions at ascending times (at least one). `turns` contains the rotation vector from each quaternion to the next in
    /// the body's frame, radians; its angle may exceed 180°. Returns `None` if times are so close that a velocity is not finite.
    pub fn through(
        times: &[f64],
        at: &[DQuat],
        turns: &[DVec3],
        interpolation: Interpolation,
    ) -> Option<Self> {
        let steps: Vec<f64> = times.windows(2).map(|t| t[1] - t[0]).collect();
        let velocities = match interpolation {
            Interpolation::Monotone => monotone_velocities(&steps, turns),
            Interpolation::Linear | Interpolation::Cubic => body_velocities(&steps, turns),
        };
        let piece = |i: usize| {
            let h = steps[i];
            let turns = match interpolation {
                Interpolation::Linear => [turns[i] / 3.0; 3],
                Interpolation::Cubic | Interpolation::Monotone => {
                    let first = velocities[i] * h / 3.0;
                    let third = velocities[i + 1] * h / 3.0;
                    let whole = at[i].conjugate() * at[i + 1];
                    let undone = DQuat::from_scaled_axis(-first) * whole;
                    let middle = undone * DQuat::from_scaled_axis(-third);
                    [first, turn_near(middle, turns[i] - first - third), third]
                }
            };
            CurveSegment {
                start: at[i],
                turns,
                duration: h,
            }
        };
        let segments: Vec<CurveSegment> = (0..steps.len()).map(piece).collect();
        let is_finite = segments.iter().flat_map(|p| p.turns).all(DVec3::is_finite);
        is_finite.then_some(Self {
            segments,
            last: at[at.len() - 1],
        })
    }

    /// Returns the rotation at a moment, as a unit quaternion.
    pub fn rotation(&self, at: Moment) -> DQuat {
        match at {
            Moment::Before => self.segments.first().map_or(self.last, |piece| piece.start),
            Moment::After => self.last,
            Moment::In { piece, elapsed } => {
                let CurveSegment {
                    start,
                    turns,
                    duration,
                } = self.segments[piece];
                let s = elapsed / duration;
                let left = 1.0 - s;
                let shares = [1.0 - left * left * left, s * s * (3.0 - 2.0 * s), s * s * s];
                let parts = turns.into_iter().zip(shares);
                let turned = parts.fold(start, |q, (w, b)| q * DQuat::from_scaled_axis(w * b));
                turned.normalize()
            }
        }
    }
}

/// Returns the angular velocity at each waypoint in the body's frame, rad/s. The velocity is zero at the first and last waypoint. Elsewhere it is the velocity
/// of the parabola through three waypoints, so that a uniform rotation stays uniform.
fn body_velocities(steps: &[f64], turns: &[DVec3]) -> Vec<DVec3> {
    let mut velocities = vec![DVec3::ZERO; steps.len() + 1];
    for i in 1..steps.len() {
        let (before, after) = (steps[i - 1], steps[i]);
        let mean = turns[i - 1] / before * after + turns[i] / after * before;
        velocities[i] = mean / (before + after);
    }
    velocities
}

/// Returns angular velocities at the waypoints, in the body's frame, rad/s, for which a turn about one axis stays between its waypoints. The velocity is zero
/// at the first and last waypoint and at reversals. Elsewhere its direction bisects the turns before and after the waypoint, and its magnitude is the
/// [`monotone_slope`] of their components along this direction. The first control turn is v h / 3, with the velocity v at the waypoint and the duration h.
/// Its end is then no farther from either waypoint than the waypoints are from each other. For the third control turn the bound is symmetric.
fn monotone_velocities(steps: &[f64], turns: &[DVec3]) -> Vec<DVec3> {
    let mut velocities = vec![DVec3::ZERO; steps.len() + 1];
    for i in 1..steps.len() {
        let (before, after) = (turns[i - 1] / steps[i - 1], turns[i] / steps[i]);
        let middle = before.normalize_or_zero() + after.normalize_or_zero();
        let along = middle.normalize_or_zero();
        let secants = [before.dot(along), after.dot(along)];
        velocities[i] = monotone_slope([steps[i - 1], steps[i]], secants) * along;
    }
    velocities
}

/// Returns the rotation vector of a unit quaternion that is nearest to `expected`, radians, among the vectors that differ by whole turns.
pub(super) fn turn_near(q: DQuat, expected: DVec3) -> DVec3 {
    let shortest = rotation_vector(q);
    // The axis of a turn by almost 0 is only rounding.
    let axis = match shortest.length() > 1e-9 {
        true => shortest.normalize(),
        false => expected.normalize_or_zero(),
    };
    let n_turns = ((expected - shortest).dot(axis) / TAU).round();
    shortest + n_turns * TAU * axis
}

/// Returns the rotation vector of a unit quaternion for the shorter of the two possible turns, radians.
pub(super) fn rotation_vector(q: DQuat) -> DVec3 {
    let q = if q.w < 0.0 { -q } else { q };
    let sine = q.xyz().length();
    if sine == 0.0 {
        return DVec3::ZERO;
    }
    q.xyz() * (2.0 * sine.atan2(q.w) / sine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use crate::world::fixtures::vector;
    use std::f64::consts::FRAC_PI_2;

    const TIMES: [f64; 4] = [0.0, 0.7, 1.0, 2.5];

    fn way_points() -> [DQuat; 4] {
        let turns = [[0.1, 0.2, 0.3], [1.0, -0.4, 0.2], [1.1, 0.9, -0.8]];
        let [a, b, c] = turns.map(|turn| DQuat::from_scaled_axis(DVec3::from(turn)));
        [a, b, c, DQuat::from_scaled_axis(DVec3::new(-0.5, 0.3, 2.0))]
    }

    fn through(times: &[f64], at: &[DQuat], kind: Interpolation) -> Option<RotationCurve> {
        let turns = at
            .windows(2)
            .map(|q| rotation_vector(q[0].conjugate() * q[1]));
        RotationCurve::through(times, at, &turns.collect::<Vec<DVec3>>(), kind)
    }

    fn angular_velocity(curve: &RotationCurve, time: f64, dt: f64) -> DVec3 {
        let at = |time| curve.rotation(Moment::new(time, &TIMES));
        rotation_vector(at(time).conjugate() * at(time + dt)) / dt
    }

    #[test]
    fn linear_is_slerp() {
        let at = way_points();
        let curve = through(&TIMES, &at, Interpolation::Linear).unwrap();
        for share in [0.1, 0.5, 0.9] {
            let found = curve.rotation(Moment::new(0.7 + 0.3 * share, &TIMES));
            let apart = found.angle_between(at[1].slerp(at[2], share));
            assert!(apart < 1e-7, "{share}");
        }
    }

    #[test]
    fn the_angular_velocity_is_continuous_and_zero_at_the_ends() {
        for kind in [Interpolation::Cubic, Interpolation::Monotone] {
            let curve = through(&TIMES, &way_points(), kind).unwrap();
            let dt = 1e-6;
            for time in [0.7, 1.0] {
                let before = angular_velocity(&curve, time - dt, dt);
                let after = angular_velocity(&curve, time, dt);
                assert!(before.length() > 0.3, "it passes, it does not stop");
                let jump = (before - after).length();
                assert!(jump < 1e-4, "{time}: {before}, {after}");
            }
            assert!(angular_velocity(&curve, 0.0, dt).length() < 1e-4);
            assert!(angular_velocity(&curve, 2.5 - dt, dt).length() < 1e-4);
        }
    }

    #[test]
    fn a_monotone_turn_stays_between_its_way_points() {
        let yaw = |degrees: f64| DQuat::from_rotation_z(degrees.to_radians());
        let at = [yaw(0.0), yaw(0.0), yaw(90.0), yaw(90.0)];
        let curve = through(&TIMES, &at, Interpolation::Monotone).unwrap();
        let mut last = 0.0;
        for k in 0..=2500 {
            let turn = rotation_vector(curve.rotation(Moment::new(1e-3 * f64::from(k), &TIMES)));
            assert!(turn.truncate().length() < 1e-15, "about z: {turn}");
            let range = last - 1e-15..=FRAC_PI_2 + 1e-15;
            assert!(range.contains(&turn.z), "{turn}");
            last = turn.z;
        }
        assert_eq!(curve.rotation(Moment::After), yaw(90.0));
    }

    #[test]
    fn a_monotone_turn_in_space_is_never_farther_from_a_way_point_than_the_next_one() {
        let mut rng = Seed::new(2018).named("monotone turns").rng();
        let apart = |a: DQuat, b: DQuat| rotation_vector(a.conjugate() * b).length();
        for case in 0..200 {
            let at = [(); 4].map(|()| DQuat::from_scaled_axis(1.5 * vector(&mut rng)));
            let curve = through(&TIMES, &at, Interpolation::Monotone).unwrap();
            for piece in 0..3 {
                let whole = apart(at[piece], at[piece + 1]);
                for step in 0..=50 {
                    let share = f64::from(step) / 50.0;
                    let time = TIMES[piece] + share * (TIMES[piece + 1] - TIMES[piece]);
                    let here = curve.rotation(Moment::new(time, &TIMES));
                    let farthest = apart(at[piece], here).max(apart(here, at[piece + 1]));
                    assert!(farthest <= whole + 1e-7, "{case} {piece} {share}");
                }
            }
        }
    }

    #[test]
    fn every_way_point_is_passed() {
        use Interpolation::{Cubic, Linear, Monotone};
        for kind in [Linear, Cubic, Monotone] {
            let curve = through(&TIMES, &way_points(), kind).unwrap();
            for (&time, q) in TIMES.iter().zip(way_points()) {
                for time in [time, time - 1e-13] {
                    let found = curve.rotation(Moment::new(time, &TIMES));
                    assert!((1.0 - found.dot(q).abs()).abs() < 1e-14, "{kind:?} {time}");
                }
            }
        }
    }
}
