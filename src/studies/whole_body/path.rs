//! Path of an object: sinusoidal motion about a pose in the frame of a link.

use crate::geometry::Pose;
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

/// Path of an object. At time t, the object is rotated about the link's z axis by s · swing and translated by s · moves, with s = sin(2π t / period).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path {
    /// Pose of the link in the world, `world_from_link`.
    pub world_from_link: Pose,
    /// Initial pose of the object in the link's frame, `link_from_object`.
    pub start: Pose,
    /// Amplitude of the translation in the link's frame, metres.
    pub moves: DVec3,
    /// Amplitude of the rotation, radians.
    pub swing: f64,
    /// Period of the motion, seconds.
    pub period: f64,
}

impl Path {
    /// Creates the path of an object that does not move.
    pub fn resting(start: Pose) -> Self {
        Self {
            world_from_link: Pose::IDENTITY,
            start,
            moves: DVec3::ZERO,
            swing: 0.0,
            period: 1.0,
        }
    }

    /// Returns the pose of the object in the world, `world_from_object`, at a time (seconds).
    pub fn at(&self, time: f64) -> Pose {
        let share = (TAU * time / self.period).sin();
        let moved = Pose::new(
            DQuat::from_rotation_z(share * self.swing),
            share * self.moves,
        );
        self.world_from_link.compose(&moved.compose(&self.start))
    }

    /// Returns a copy of the path with its start shifted in the link's frame (metres).
    pub fn shifted(&self, by: DVec3) -> Self {
        Self {
            start: Pose::new(self.start.rotation, self.start.translation + by),
            ..*self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_comes_back_after_its_period_and_is_farthest_after_a_quarter() {
        let path = Path {
            world_from_link: Pose::from_translation(DVec3::Z),
            start: Pose::from_translation(DVec3::X),
            moves: 0.5 * DVec3::Z,
            swing: 0.5 * std::f64::consts::PI,
            period: 2.0,
        };
        let place = |time: f64| path.at(time).translation;
        assert_eq!(place(0.0), DVec3::new(1.0, 0.0, 1.0));
        assert!(place(2.0).distance(place(0.0)) < 1e-15);
        assert!(place(0.5).distance(DVec3::new(0.0, 1.0, 1.5)) < 1e-15);
        assert!(place(1.5).distance(DVec3::new(0.0, -1.0, 0.5)) < 1e-15);
    }
}
