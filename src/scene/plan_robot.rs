//! Robots of an executable scene: checked motions, and the state of a robot during a simulation.

use super::reader::Reader;
use super::spec::{JointsSpec, ROBOT_RULES, RobotSpec};
use super::spec_motion::JOINTS_RULES;
use crate::error::Result;
use crate::geometry::Pose;
use crate::spelling::nearest_names;
use crate::world::{Joint, JointTrajectory, MeshFolders, Motion, Robot};
use ndarray::Array2;
use std::path::Path;

/// Robot of a scene, checked and ready for simulation.
#[derive(Clone, Debug)]
pub struct PlannedRobot {
    /// Name of the robot in the scene.
    pub name: String,
    /// Links and joints of the robot, read from its file.
    pub robot: Robot,
    /// Folders in which mesh files of the links are searched.
    pub meshes: MeshFolders,
    /// Motion of the robot's base.
    pub base: Motion,
    /// Motion of the joints; `None` if all joints stay at their rest positions.
    pub joints: Option<JointTrajectory>,
}

impl PlannedRobot {
    /// Returns the time at which the robot's motion ends, seconds.
    pub fn end(&self) -> f64 {
        let joints = self.joints.as_ref().map_or(0.0, JointTrajectory::end);
        self.base.end().max(joints)
    }
}

impl Reader<'_> {
    /// Checks a robot of a scene file and reads the robot's file.
    pub fn robot(&self, spec: &RobotSpec) -> Result<PlannedRobot> {
        let key = &format!("robots.{}", spec.name);
        self.check.rules(key, spec, ROBOT_RULES)?;
        let file = spec.file.as_ref().map(|path| ("file", path));
        let file = file.or(spec.urdf.as_ref().map(|path| ("urdf", path)));
        let (robot, meshes) = match file {
            Some((name, path)) => self.robot_file(key, name, path, spec)?,
            None => (Robot::floating(&spec.name), MeshFolders::default()),
        };
        Ok(PlannedRobot {
            name: spec.name.clone(),
            base: self.motion(key, &spec.at, spec.motion.as_ref())?,
            joints: self.joints(&format!("{key}.joints"), spec.joints.as_ref(), &robot)?,
            robot,
            meshes,
        })
    }

    /// Reads the URDF or MJCF file of a robot, which the key `name` contains; also returns the folders of its meshes.
    fn robot_file(
        &self,
        key: &str,
        name: &str,
        path: &Path,
        spec: &RobotSpec,
    ) -> Result<(Robot, MeshFolders)> {
        let file_key = &format!("{key}.{name}");
        let robot = self.read(file_key, path, Robot::read)?;
        let path = self.path(path);
        let packages = spec.packages.iter().map(|(package, folder)| {
            let folder = self.path(folder);
            if folder.is_dir() {
                return Ok((package.clone(), folder));
            }
            let key = format!("{key}.packages.{package}");
            let given = format!("{}, which is no folder", folder.display());
            self.refuse(&key, given, "a folder, its path relative to the scene's")
        });
        let packages = packages.collect::<Result<_>>()?;
        Ok((robot, MeshFolders::beside(&path, packages)))
    }

    /// Checks the waypoints of a robot's joints and returns the joint motion.
    pub fn joints(
        &self,
        key: &str,
        joints: Option<&JointsSpec>,
        robot: &Robot,
    ) -> Result<Option<JointTrajectory>> {
        let Some(joints) = joints else {
            return Ok(None);
        };
        if robot.coordinates().is_empty() {
            let given = "a trajectory of a robot whose joints do not move";
            return self.refuse(key, given, "no such key");
        }
        self.check.rules(key, joints, JOINTS_RULES)?;
        let interpolation = joints.interpolation.unwrap_or_default();
        let trajectory = match &joints.csv {
            Some(path) => {
                let (place, file) = self.open(&format!("{key}.csv"), path)?;
                JointTrajectory::read_csv(robot, &place, file, interpolation)
            }
            None => {
                let positions = self.positions(key, joints, robot)?;
                JointTrajectory::new(robot, joints.time_s.clone(), positions, interpolation)
            }
        };
        self.under(key, trajectory).map(Some)
    }

    /// Returns the joint positions at all way-points, shape (n_times, n_coordinates), rad and m. Joints that are not listed stay at their rest positions.
    fn positions(&self, key: &str, joints: &JointsSpec, robot: &Robot) -> Result<Array2<f64>> {
        let key = &format!("{key}.positions");
        let n_times = joints.time_s.len();
        let rest = robot.rest_positions();
        let mut positions =
            Array2::from_shape_fn((n_times, rest.len()), |(_, column)| rest[column]);
        let mut found = vec![false; robot.n_positions()];
        for (given, values) in &joints.positions {
            let mut coordinates = robot.coordinates().iter().enumerate();
            let place = coordinates.find_map(|(column, coordinate)| {
                let suffix = given.strip_prefix(&coordinate.name)?;
                // The first unit is empty, but here each name needs a unit.
                let mut units = coordinate.dimension.units().iter().skip(1);
                let found = units.find(|(unit, _)| *unit == suffix);
                found.map(|(_, scale)| (column, scale))
            });
            let Some((column, scale)) = place else {
                return self.refuse_position(key, given, robot);
            };
            if std::mem::replace(&mut found[column], true) {
                let given = format!("`{given}`, in a second unit");
                return self.refuse(key, given, "one list a joint");
            }
            if values.len() != n_times {
                let given = format!("`{given}` with {} numbers", values.len());
                let allowed = format!("{n_times}, one a time of time_s");
                return self.refuse(key, given, allowed);
            }
            for (row, value) in values.iter().enumerate() {
                positions[(row, column)] = scale * value;
            }
        }
        Ok(positions)
    }

    /// Returns the error of a key of `positions` that is not the name of a joint that moves, with a unit.
    fn refuse_position<T>(&self, key: &str, given: &str, robot: &Robot) -> Result<T> {
        let bare = given.rsplit_once('_').map_or(given, |(bare, _)| bare);
        if let Some(joint) = robot.joints().iter().find(|joint| joint.name == bare) {
            let given = format!("`{given}`, and joint `{bare}` {}", stays(joint, robot));
            return self.refuse(key, given, "joints that move and mimic none");
        }
        let names = robot.coordinates().iter().map(|c| c.name.as_str());
        let unit = "with _deg, _rad, _mm or _m";
        let allowed = format!("{} {unit}", nearest_names(bare, names));
        self.refuse(key, format!("`{given}`"), allowed)
    }
}

/// Returns the reason, as text, why the scene cannot move a joint.
fn stays(joint: &Joint, robot: &Robot) -> String {
    match joint.mimic {
        Some(mimic) => format!("mimics `{}`", robot.joints()[mimic.joint].name),
        None => match joint.kind.coordinates() {
            [] => "is fixed".to_owned(),
            coordinates => {
                let names = coordinates
                    .iter()
                    .map(|(suffix, _)| format!("`{}{suffix}`", joint.name));
                format!(
                    "has the coordinates {}",
                    names.collect::<Vec<_>>().join(", ")
                )
            }
        },
    }
}

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
