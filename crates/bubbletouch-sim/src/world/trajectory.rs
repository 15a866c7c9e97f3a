//! Given motion of a floating robot: piecewise-constant velocities \[BT\].

use crate::error::{Error, Result};
use crate::geometry::{Pose, check_poses};
use crate::text::in_range::not_negative;
use glam::{DQuat, DVec3};

/// Phase of a motion with constant velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// Duration of the phase, seconds, zero or positive.
    pub duration: f64,
    /// Velocity of the body's origin in the world, m/s.
    pub linear: DVec3,
    /// Angular velocity in the world, rad/s, about the body's origin.
    pub angular: DVec3,
}

/// Pose of a body over time: a start pose, then phases of constant velocity, then standstill.
///
/// Rotations are integrated exactly, `R(t) = exp(ω t) R(0)`. Differences from \[BT\]: the original program adds ω × R to the rotation matrix R at each step,
/// so that the matrix grows. The original program also switches phases one step early.
#[derive(Clone, Debug, PartialEq)]
pub struct VelocityPlan {
    start: Pose,
    phases: Vec<Phase>,
}

impl VelocityPlan {
    /// Creates a motion that starts at a pose and runs through the phases in order.
    ///
    /// # Errors
    /// If a phase has a negative duration or a value that is not finite; the error contains the first such phase (from 1). If the start pose is not finite or
    /// has no unit quaternion.
    pub fn new(start: Pose, phases: Vec<Phase>) -> Result<Self> {
        check_poses("body", 1, &[start])?;
        for (index, phase) in phases.iter().enumerate() {
            let place = format!("velocity plan, phase {}", index + 1);
            not_negative(&format!("{place}: duration"), phase.duration, "s")?;
            if !(phase.linear.is_finite() && phase.angular.is_finite()) {
                let given = format!("velocity {} m/s, {} rad/s", phase.linear, phase.angular);
                return Err(Error::input(place, given, "finite numbers"));
            }
        }
        Ok(Self { start, phases })
    }

    /// Returns the time at which the last phase ends, seconds.
    pub fn duration(&self) -> f64 {
        self.phases.iter().map(|p| p.duration).sum()
    }

    /// Returns the pose `world_from_body` at a time in seconds: the start pose before time 0, the final pose after the last phase.
    pub fn pose_at(&self, time: f64) -> Pose {
        let mut pose = self.start;
        let mut left = time.max(0.0);
        for phase in &self.phases {
            let dt = left.min(phase.duration);
            pose = Pose::new(
                (DQuat::from_scaled_axis(phase.angular * dt) * pose.rotation).normalize(),
                pose.translation + phase.linear * dt,
            );
            left -= dt;
            if left <= 0.0 {
                break;
            }
        }
        pose
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_quarter_turn_in_two_phases_is_a_quarter_turn_in_one() {
        let turn = |duration| Phase {
            duration,
            linear: DVec3::new(0.0, 0.1, 0.0),
            angular: DVec3::new(0.0, 0.0, FRAC_PI_2),
        };
        let one = VelocityPlan::new(Pose::IDENTITY, vec![turn(1.0)]).unwrap();
        let two = VelocityPlan::new(Pose::IDENTITY, vec![turn(0.25), turn(0.75)]).unwrap();
        let end = one.pose_at(1.0);
        for pose in [end, two.pose_at(1.0)] {
            let point = pose.transform_point(DVec3::X);
            assert!(point.distance(DVec3::new(0.0, 1.1, 0.0)) < 1e-15, "{point}");
        }
        assert_eq!(one.pose_at(5.0), end, "it rests where it ended");
        assert_eq!(one.duration(), two.duration());
    }

    #[test]
    fn a_million_small_steps_keep_the_rotation_a_rotation() {
        let phase = Phase {
            duration: 1e-5,
            linear: DVec3::ZERO,
            angular: DVec3::new(3.0, -2.0, 1.0),
        };
        let plan = VelocityPlan::new(Pose::IDENTITY, vec![phase; 100_000]).unwrap();
        assert!((plan.pose_at(1.0).rotation.length() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_negative_duration_is_refused_with_its_phase() {
        let phase = Phase {
            duration: -1.0,
            linear: DVec3::ZERO,
            angular: DVec3::ZERO,
        };
        let error = VelocityPlan::new(Pose::IDENTITY, vec![phase]).unwrap_err();
        let said = "velocity plan, phase 1: duration: -1 s; zero or a positive number";
        assert_eq!(error.to_string(), said);
    }
}
