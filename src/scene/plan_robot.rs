//! Robots of an executable scene, with checked motions.

use super::reader::Reader;
use super::spec::RobotSpec;
use crate::error::Result;
use crate::scene::spec_motion::JointsSpec;
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
        let (robot, meshes) = match (&spec.file, &spec.urdf, spec.floating) {
            (None, None, true) => (Robot::floating(&spec.name), MeshFolders::default()),
            (Some(path), None, false) => self.robot_file(key, "file", path, spec)?,
            (None, Some(path), false) => self.robot_file(key, "urdf", path, spec)?,
            _ => {
                let allowed = "either file = \"FILE\" or floating = true";
                return Err(self.check.error(key, "both or neither", allowed));
            }
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
        self.open(file_key, path)?;
        let path = self.path(path);
        let robot = self.under(file_key, Robot::read(&path))?;
        let packages = spec.packages.iter().map(|(package, folder)| {
            let folder = self.path(folder);
            if folder.is_dir() {
                return Ok((package.clone(), folder));
            }
            let key = format!("{key}.packages.{package}");
            let given = format!("{}, which is no folder", folder.display());
            Err(self
                .check
                .error(&key, given, "a folder, its path relative to the scene's"))
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
        let coordinates = robot.coordinates();
        let joints = match (joints, coordinates.first()) {
            (None, _) => return Ok(None),
            (Some(_), None) => {
                let given = "a trajectory of a robot whose joints do not move";
                return Err(self.check.error(key, given, "no such key"));
            }
            (Some(joints), Some(_)) => joints,
        };
        let interpolation = joints.interpolation.unwrap_or_default();
        let is_here = !(joints.time_s.is_empty() && joints.positions.is_empty());
        let trajectory = match &joints.csv {
            Some(_) if is_here => {
                let allowed = "either csv, or time_s and positions";
                return Err(self.check.error(key, "both", allowed));
            }
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
            let names = robot.coordinates().iter().map(|c| c.name.as_str());
            let place = robot
                .coordinates()
                .iter()
                .enumerate()
                .find_map(|(column, c)| {
                    let suffix = given.strip_prefix(&c.name)?;
                    // The first unit is empty, but here each name needs a unit.
                    let mut units = c.dimension.units().iter().skip(1);
                    units
                        .find(|(unit, _)| *unit == suffix)
                        .map(|(_, scale)| (column, scale))
                });
            let Some((column, scale)) = place else {
                let bare = given
                    .rsplit_once('_')
                    .map_or(given.as_str(), |(bare, _)| bare);
                if let Some(joint) = robot.joints().iter().find(|joint| joint.name == bare) {
                    let given = format!("`{given}`, and joint `{bare}` {}", stays(joint, robot));
                    return Err(self
                        .check
                        .error(key, given, "joints that move and mimic none"));
                }
                let unit = "with _deg, _rad, _mm or _m";
                let allowed = format!("{} {unit}", nearest_names(bare, names));
                return Err(self.check.error(key, format!("`{given}`"), allowed));
            };
            if std::mem::replace(&mut found[column], true) {
                let given = format!("`{given}`, in a second unit");
                return Err(self.check.error(key, given, "one list a joint"));
            }
            if values.len() != n_times {
                let given = format!("`{given}` with {} numbers", values.len());
                let allowed = format!("{n_times}, one a time of time_s");
                return Err(self.check.error(key, given, allowed));
            }
            for (row, value) in values.iter().enumerate() {
                positions[(row, column)] = scale * value;
            }
        }
        Ok(positions)
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
