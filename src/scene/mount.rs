//! What carries skins, and objects that ride along: the world, a link of a robot, an object.

use super::plan_robot::PlannedRobot;
use super::reader::Reader;
use super::robot_state::RobotState;
use super::spec::{ObjectSpec, PatchSpec};
use crate::error::Result;
use crate::geometry::Pose;
use crate::scene::spec_motion::PoseSpec;

/// What carries something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mount {
    /// Nothing: it stays where it is, `world_from_mounted`.
    World(Pose),
    /// A robot's link.
    Link {
        /// The robot's number.
        robot: usize,
        /// The link's number in the robot.
        link: usize,
        /// Where it is on the link.
        link_from_mounted: Pose,
    },
    /// An object.
    Object {
        /// Its number in the scene.
        object: usize,
        /// Where it is on the object.
        object_from_mounted: Pose,
    },
}

impl Mount {
    /// Where what is mounted is, in the world.
    pub(super) fn place(&self, robots: &[RobotState], world_from_objects: &[Pose]) -> Pose {
        match self {
            Self::World(pose) => *pose,
            Self::Link {
                robot,
                link,
                link_from_mounted,
            } => robots[*robot].world_from_link[*link].compose(link_from_mounted),
            Self::Object {
                object,
                object_from_mounted,
            } => world_from_objects[*object].compose(object_from_mounted),
        }
    }
}

impl Reader<'_> {
    /// What carries a patch.
    pub fn mount_of_patch(
        &self,
        key: &str,
        spec: &PatchSpec,
        robots: &[PlannedRobot],
        objects: &[ObjectSpec],
    ) -> Result<Mount> {
        let Some(name) = &spec.object else {
            let on = (spec.robot.as_deref(), spec.link.as_deref());
            return self.mount(key, on, &spec.at, robots);
        };
        let at = self.pose(&format!("{key}.at"), &spec.at)?;
        let key = &format!("{key}.object");
        if spec.robot.is_some() || spec.link.is_some() {
            let allowed = "either an object or a robot that carries it";
            return Err(self.check.error(key, "given beside a robot", allowed));
        }
        let names = objects.iter().map(|object| object.name.as_str());
        let object = self.known(key, name, names)?;
        if objects[object].free.is_some() || objects[object].press.is_some() {
            let given = format!("`{name}`, which does not go where it is told");
            let allowed = "an object that is neither free nor pushed";
            return Err(self.check.error(key, given, allowed));
        }
        Ok(Mount::Object {
            object,
            object_from_mounted: at,
        })
    }

    /// What carries something that names a robot and its link, or neither.
    pub fn mount(
        &self,
        key: &str,
        (robot, link): (Option<&str>, Option<&str>),
        at: &PoseSpec,
        robots: &[PlannedRobot],
    ) -> Result<Mount> {
        let at = self.pose(&format!("{key}.at"), at)?;
        let Some(name) = robot else {
            return match link {
                None => Ok(Mount::World(at)),
                Some(link) => Err(self.check.error(
                    &format!("{key}.link"),
                    format!("`{link}` without a robot"),
                    "robot = \"NAME\" beside it",
                )),
            };
        };
        let names = robots.iter().map(|robot| robot.name.as_str());
        let robot = self.known(&format!("{key}.robot"), name, names)?;
        let carrier = &robots[robot].robot;
        let link = match link {
            Some(link) => self.under(&format!("{key}.link"), carrier.link(link))?,
            None => carrier.base(),
        };
        Ok(Mount::Link {
            robot,
            link,
            link_from_mounted: at,
        })
    }
}
