//! Motion: way-points in time → where joints and bodies are at any time.
//!
//! Between way-points each number is a cubic of time; outside their range of time the ends hold.
//!
//! | interpolation | between way-points | continuous |
//! |---|---|---|
//! | linear | straight; rotations by slerp | position |
//! | cubic | clamped spline: velocity zero at both ends | acceleration (rotations: angular velocity) |
//! | monotone | never beyond its two way-points \[FC\] | velocity |

mod curve;
mod joint_limits;
mod joint_trajectory;
mod pose_trajectory;
mod rotation_curve;
mod slopes;
mod way_point_csv;
mod way_points;

pub use curve::Interpolation;
pub use joint_trajectory::JointTrajectory;
pub use pose_trajectory::PoseTrajectory;

use super::VelocityPlan;
use crate::geometry::Pose;

/// How a body moves that nothing can stop: a robot's base, or an object.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// It stays.
    Fixed(Pose),
    /// Piecewise-constant velocities.
    Plan(VelocityPlan),
    /// Way-points.
    WayPoints(PoseTrajectory),
}

impl Motion {
    /// `world_from_body` at a time in seconds.
    pub fn pose_at(&self, time: f64) -> Pose {
        match self {
            Self::Fixed(pose) => *pose,
            Self::Plan(plan) => plan.pose_at(time),
            Self::WayPoints(trajectory) => trajectory.pose_at(time),
        }
    }

    /// The time in seconds after which nothing moves; 0 for what stays.
    pub fn end(&self) -> f64 {
        match self {
            Self::Fixed(_) => 0.0,
            Self::Plan(plan) => plan.duration(),
            Self::WayPoints(trajectory) => trajectory.end(),
        }
    }
}
