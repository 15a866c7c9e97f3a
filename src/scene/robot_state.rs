//! A robot on its way: where its links are now.

use super::plan_robot::PlannedRobot;
use crate::error::Result;
use crate::geometry::Pose;

/// The links of a robot at one time.
#[derive(Clone, Debug)]
pub(super) struct RobotState {
    positions: Vec<f64>,
    /// Whether they were set by hand, and no longer follow the plan.
    are_set: bool,
    /// `world_from_base`, if it was put somewhere by hand.
    pub base: Option<Pose>,
    /// One a link.
    pub world_from_link: Vec<Pose>,
}

impl RobotState {
    pub fn of(robot: &PlannedRobot) -> Self {
        Self {
            positions: robot.robot.rest_positions(),
            are_set: false,
            base: None,
            world_from_link: vec![Pose::IDENTITY; robot.robot.links().len()],
        }
    }

    /// From now on its joints are here; rad and m, one a coordinate.
    pub fn set_positions(&mut self, positions: &[f64]) {
        self.positions.copy_from_slice(positions);
        self.are_set = true;
    }

    /// Goes to where it is at a time.
    pub fn place(&mut self, robot: &PlannedRobot, time: f64) -> Result<()> {
        if let (Some(joints), false) = (&robot.joints, self.are_set) {
            joints.positions_into(time, &mut self.positions);
        }
        let base = self.base.unwrap_or_else(|| robot.base.pose_at(time));
        let links = &mut self.world_from_link;
        robot.robot.forward_into(&base, &self.positions, links)
    }
}
