//! Bodies that carry patches and objects: the world, links of robots, and objects.

use super::plan_robot::RobotState;
use super::reader::Reader;
use crate::error::Result;
use crate::geometry::Pose;

/// Body in whose frame the pose of a patch or an object is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Carrier {
    /// The world.
    World,
    /// Link of a robot.
    Link {
        /// Index of the robot in the scene.
        robot: usize,
        /// Index of the link in the robot.
        link: usize,
    },
    /// Object of the scene, given by its index; it carries patches only.
    Object(usize),
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

impl Reader<'_> {
    /// Returns the carrier that is described by an optional robot name and an optional link name: the world without a robot, the base without a link.
    pub fn carrier(
        &self,
        key: &str,
        (robot, link): (Option<&str>, Option<&str>),
    ) -> Result<Carrier> {
        let Some(robot) = robot else {
            return Ok(Carrier::World);
        };
        let names = self.robots.iter().map(|robot| robot.name.as_str());
        let robot = self.known(&format!("{key}.robot"), robot, names)?;
        let carrier = &self.robots[robot].robot;
        let link = match link {
            Some(link) => self.under(&format!("{key}.link"), carrier.link(link))?,
            None => carrier.base(),
        };
        Ok(Carrier::Link { robot, link })
    }
}
