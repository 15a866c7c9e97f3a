//! A robot on its way: where its links are now.

use super::plan_robot::PlannedRobot;
use crate::error::Result;
use crate::geometry::Pose;

/// The links of a robot at one time.
#[derive(Clone, Debug)]
pub(super) struct RobotState {
    positions: Vec<f64>,
    /// One a link.
    pub world_from_link: Vec<Pose>,
}

impl RobotState {
    pub fn of(robot: &PlannedRobot) -> Self {
        Self {
            positions: vec![0.0; robot.robot.n_positions()],
            world_from_link: vec![Pose::IDENTITY; robot.robot.links().len()],
        }
    }

    /// Goes to where it is at a time.
    pub fn place(&mut self, robot: &PlannedRobot, time: f64) -> Result<()> {
        if let Some(joints) = &robot.joints {
            joints.positions_into(time, &mut self.positions);
        }
        let base = robot.base.pose_at(time);
        let links = &mut self.world_from_link;
        robot.robot.forward_into(&base, &self.positions, links)
    }
}
