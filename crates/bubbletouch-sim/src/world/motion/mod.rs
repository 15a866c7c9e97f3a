//! Motion: trajectories through waypoints, as poses and joint positions at any time.
//!
//! Between waypoints each number is a cubic polynomial of time; before the first and after the last waypoint the values are constant.
//!
//! | interpolation | between waypoints | continuous |
//! |---|---|---|
//! | linear | straight; rotations by slerp | position |
//! | cubic | clamped spline: velocity zero at both ends | acceleration (rotations: angular velocity) |
//! | monotone | never beyond its two waypoints \[FC\] | velocity |

mod curve;
mod joint_limits;
mod joint_trajectory;
mod oscillation;
mod pose_trajectory;
mod rotation_curve;
mod slopes;
mod way_point_csv;
mod way_points;

pub use curve::Interpolation;
pub use joint_trajectory::JointTrajectory;
pub use oscillation::Oscillation;
pub use pose_trajectory::PoseTrajectory;

use super::VelocityPlan;
use crate::geometry::Pose;

/// Motion of a robot's base or of an object that is given in advance.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// Pose that does not change.
    Fixed(Pose),
    /// Phases with constant velocities.
    Plan(VelocityPlan),
    /// Pose interpolated between waypoints.
    WayPoints(PoseTrajectory),
    /// Sinusoidal motion about a pose.
    Oscillation(Oscillation),
}

impl Motion {
    /// Returns the pose of the body in the fixed frame, `world_from_body`, at a time in seconds.
    pub fn pose_at(&self, time: f64) -> Pose {
        match self {
            Self::Fixed(pose) => *pose,
            Self::Plan(plan) => plan.pose_at(time),
            Self::WayPoints(trajectory) => trajectory.pose_at(time),
            Self::Oscillation(oscillation) => oscillation.pose_at(time),
        }
    }

    /// Returns the time in seconds at which the motion ends; 0 for a fixed body, one period for an oscillation.
    pub fn end(&self) -> f64 {
        match self {
            Self::Fixed(_) => 0.0,
            Self::Plan(plan) => plan.duration(),
            Self::WayPoints(trajectory) => trajectory.end(),
            Self::Oscillation(oscillation) => oscillation.period,
        }
    }
}
