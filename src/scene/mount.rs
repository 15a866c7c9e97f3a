//! Mounts of patches, by which patches are fixed to the world, to a robot's link, or to an object.

use super::plan_robot::PlannedRobot;
use super::reader::Reader;
use super::robot_state::RobotState;
use super::spec::{ObjectSpec, PatchSpec};
use crate::error::Result;
use crate::geometry::Pose;
use crate::scene::spec_motion::PoseSpec;

/// Body to which a patch of skin or another mounted body is fixed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mount {
    /// The body is fixed to the world; its pose `world_from_mounted` is constant.
    World(Pose),
    /// The body is fixed to a link of a robot.
    Link {
        /// Index of the robot in the scene.
        robot: usize,
        /// Index of the link in the robot.
        link: usize,
        /// Pose of the mounted body on the link, `link_from_mounted`.
        link_from_mounted: Pose,
    },
    /// The body is fixed to an object of the scene.
    Object {
        /// Index of the object in the scene.
        object: usize,
        /// Pose of the mounted body on the object, `object_from_mounted`.
        object_from_mounted: Pose,
    },
}

impl Mount {
    /// Returns the pose of the mounted body in the world, `world_from_mounted`.
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
    /// Returns the body to which a patch is fixed: an object, a robot link, or the world.
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

    /// Returns the mount that is described by an optional robot name and an optional link name.
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
        let (robot, link) = self.link(key, (name, link), robots)?;
        Ok(Mount::Link {
            robot,
            link,
            link_from_mounted: at,
        })
    }

    /// Returns the index of a robot and of its link with the given name; if no name is given, the base link.
    pub fn link(
        &self,
        key: &str,
        (robot, link): (&str, Option<&str>),
        robots: &[PlannedRobot],
    ) -> Result<(usize, usize)> {
        let names = robots.iter().map(|robot| robot.name.as_str());
        let robot = self.known(&format!("{key}.robot"), robot, names)?;
        let carrier = &robots[robot].robot;
        let link = match link {
            Some(link) => self.under(&format!("{key}.link"), carrier.link(link))?,
            None => carrier.base(),
        };
        Ok((robot, link))
    }
}
