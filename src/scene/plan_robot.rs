//! Robots of an executable scene: their files and motions, and the bodies that carry patches and objects.

use super::planned::{Carrier, PlannedRobot};
use super::reader::Reader;
use super::spec::{JointsSpec, ROBOT_RULES, RobotSpec};
use super::spec_motion::JOINTS_RULES;
use crate::error::Result;
use crate::spelling::nearest_names;
use crate::world::{Joint, JointTrajectory, MeshFolders, Robot};
use ndarray::Array2;
use std::path::Path;

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
        if let Some(coordinate) = robot.coordinates().iter().find(|it| it.name == given) {
            let units = coordinate.dimension.units().iter().skip(1);
            let names: Vec<String> = units.map(|(unit, _)| format!("`{given}{unit}`")).collect();
            return self.refuse(key, format!("`{given}` without a unit"), names.join(" or "));
        }
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
