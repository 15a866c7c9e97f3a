//! Sinusoidal motion about a pose.

use crate::geometry::Pose;
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

/// Sinusoidal motion about a pose. Let s = sin(2π t / period) at time t. The body is rotated about the origin of the fixed frame by s · `angular`, then
/// translated by s · `linear`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillation {
    /// Pose at time 0.
    pub start: Pose,
    /// Amplitude of the translation, metres.
    pub linear: DVec3,
    /// Amplitude of the rotation vector, radians.
    pub angular: DVec3,
    /// Period of the oscillation, seconds, positive.
    pub period: f64,
}

impl Oscillation {
    /// Returns the motion of a body that stays at the pose `start`.
    pub fn resting(start: Pose) -> Self {
        Self {
            start,
            linear: DVec3::ZERO,
            angular: DVec3::ZERO,
            period: 1.0,
        }
    }

    /// Returns the pose at a time, seconds.
    pub fn pose_at(&self, time: f64) -> Pose {
        let share = (TAU * time / self.period).sin();
        let rotation = DQuat::from_scaled_axis(share * self.angular);
        Pose::new(rotation, share * self.linear).compose(&self.start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_comes_back_after_its_period_and_is_farthest_after_a_quarter() {
        let motion = Oscillation {
            start: Pose::from_translation(DVec3::X),
            linear: 0.5 * DVec3::Z,
            angular: 0.5 * std::f64::consts::PI * DVec3::Z,
            period: 2.0,
        };
        let place = |time: f64| motion.pose_at(time).translation;
        assert_eq!(place(0.0), DVec3::X);
        assert!(place(2.0).distance(place(0.0)) < 1e-15);
        assert!(place(0.5).distance(DVec3::new(0.0, 1.0, 0.5)) < 1e-15);
        assert!(place(1.5).distance(DVec3::new(0.0, -1.0, -0.5)) < 1e-15);
        let resting = Oscillation::resting(motion.start);
        assert_eq!(resting.pose_at(0.3), motion.start);
    }
}
