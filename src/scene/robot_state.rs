//! State of a robot during a simulation, and the poses of bodies that a robot carries.

use super::planned::{Carrier, PlannedRobot};
use crate::error::Result;
use crate::geometry::Pose;

/// Joint positions and link poses of a robot at one time.
#[derive(Clone, Debug)]
pub(super) struct RobotState<'p> {
    robot: &'p PlannedRobot,
    positions: Vec<f64>,
    /// Whether a program has set the joint positions, which then no longer follow the scene file.
    are_set: bool,
    /// Pose of the base that a program has set, `world_from_base`; `None` if the base follows the scene file.
    pub base: Option<Pose>,
    /// Pose of each link, `world_from_link`.
    pub world_from_link: Vec<Pose>,
}

impl<'p> RobotState<'p> {
    /// Creates the state of a robot with its joints at their rest positions.
    pub fn new(robot: &'p PlannedRobot) -> Self {
        Self {
            robot,
            positions: robot.robot.rest_positions(),
            are_set: false,
            base: None,
            world_from_link: vec![Pose::IDENTITY; robot.robot.links().len()],
        }
    }

    /// Sets the joint positions from now on (rad or m, one number per coordinate), in place of the motion in the scene file.
    pub fn set_positions(&mut self, positions: &[f64]) {
        self.positions.copy_from_slice(positions);
        self.are_set = true;
    }

    /// Computes the pose of each link at a time (seconds).
    pub fn place(&mut self, time: f64) -> Result<()> {
        let robot = self.robot;
        if let (Some(joints), false) = (&robot.joints, self.are_set) {
            joints.positions_into(time, &mut self.positions);
        }
        let base = self.base.unwrap_or_else(|| robot.base.pose_at(time));
        let links = &mut self.world_from_link;
        robot.robot.forward_into(&base, &self.positions, links)
    }
}

impl Carrier {
    /// Returns the pose in the world of a body, given its pose on the carrier.
    pub(super) fn place(
        self,
        carrier_from_body: &Pose,
        robots: &[RobotState],
        world_from_objects: &[Pose],
    ) -> Pose {
        match self {
            Self::World => *carrier_from_body,
            Self::Link { robot, link } => {
                robots[robot].world_from_link[link].compose(carrier_from_body)
            }
            Self::Object(object) => world_from_objects[object].compose(carrier_from_body),
        }
    }
}
