//! Reading of keys for all parts of a scene plan: errors with file and key, poses, motions, and files.

use super::spec::PlaneSpec;
use crate::contact::equilibrium::HalfSpace;
use crate::error::Result;
use crate::geometry::{Pose, rotation_from_rpy};
use crate::inputs::check::Check;
use crate::inputs::range::{not_negative, positive};
use crate::objects::Model;
use crate::scene::spec_motion::{MotionSpec, OscillationSpec, PoseSpec};
use crate::spelling::known;
use crate::world::{Motion, Oscillation, Phase, PoseTrajectory, VelocityPlan};
use glam::DVec3;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// One millimetre in metres, the factor that converts mm to m.
pub(super) const MM: f64 = 1e-3;

/// Reader that checks the values of a scene file and converts them to SI units.
pub(crate) struct Reader<'a> {
    pub check: Check<'a>,
    /// Folder to which paths in the file are relative.
    pub folder: &'a Path,
    /// Objects given in memory, by their names in the scene.
    pub models: &'a BTreeMap<String, Model>,
}

impl Reader<'_> {
    /// Adds the file name and `key` to the error message if the result is an error.
    pub fn under<T>(&self, key: &str, result: Result<T>) -> Result<T> {
        result.map_err(|error| error.under(format!("{}, key {key}: ", self.check.place)))
    }

    /// Returns the position of `name` in the list of names that the key allows, or an error if the list does not contain `name`.
    pub fn known<'n>(
        &self,
        key: &str,
        name: &str,
        names: impl Iterator<Item = &'n str> + Clone,
    ) -> Result<usize> {
        known(format!("{}, key {key}", self.check.place), name, names)
    }

    /// Returns the absolute path of a file that the scene refers to.
    pub fn path(&self, path: &Path) -> PathBuf {
        self.folder.join(path)
    }

    /// Opens a file that the scene refers to; also returns its path for error messages.
    pub fn open(&self, key: &str, path: &Path) -> Result<(String, BufReader<File>)> {
        let path = self.path(path);
        let place = path.display().to_string();
        match crate::files::open(&path) {
            Ok(file) => Ok((place, BufReader::new(file))),
            Err(error) => {
                let given = format!("{place}, which cannot be opened ({error})");
                Err(self
                    .check
                    .error(key, given, "a file, its path relative to the scene's"))
            }
        }
    }

    /// Converts a vector to SI units by the factor `unit`; the numbers must be finite.
    pub fn vector(&self, key: &str, numbers: [f64; 3], unit: f64) -> Result<DVec3> {
        for number in numbers {
            self.check
                .value(key, number, f64::is_finite, "finite numbers")?;
        }
        Ok(unit * DVec3::from_array(numbers))
    }

    /// Converts the pose in a scene file to SI units; errors name `key`.
    pub fn pose(&self, key: &str, pose: &PoseSpec) -> Result<Pose> {
        let position = self.vector(&format!("{key}.position_mm"), pose.position_mm, MM)?;
        let degree = 1f64.to_radians();
        let rpy = self.vector(&format!("{key}.rotation_deg"), pose.rotation_deg, degree)?;
        Ok(Pose::new(rotation_from_rpy(rpy), position))
    }

    /// Converts a plane of a scene file to a half-space in SI units with a unit normal.
    pub fn plane(&self, plane: &PlaneSpec) -> Result<HalfSpace> {
        let key = format!("planes.{}", plane.name);
        let point = self.vector(&format!("{key}.point_mm"), plane.point_mm, MM)?;
        let key = format!("{key}.normal");
        let normal = self.vector(&key, plane.normal, 1.0)?;
        let Some(normal) = normal.try_normalize() else {
            let allowed = "a direction of any length above zero";
            return Err(self.check.error(&key, normal, allowed));
        };
        Ok(HalfSpace {
            normal,
            height: normal.dot(point),
        })
    }

    /// Returns the motion of the body that is described under `key`, given its pose `at` and its optional imposed motion.
    pub fn motion(&self, key: &str, at: &PoseSpec, motion: Option<&MotionSpec>) -> Result<Motion> {
        let start = self.pose(&format!("{key}.at"), at)?;
        let Some(motion) = motion else {
            return Ok(Motion::Fixed(start));
        };
        let key = &format!("{key}.motion");
        let has_phases = !motion.phases.is_empty();
        let has_way_points = !motion.way_points.is_empty();
        let oscillation = motion.oscillation.as_ref();
        let ways = [
            has_phases,
            has_way_points,
            motion.csv.is_some(),
            oscillation.is_some(),
        ];
        if ways.into_iter().filter(|&is_given| is_given).count() != 1 {
            let allowed = "exactly one of phases, way_points, csv and oscillation";
            return Err(self.check.error(key, "none of them, or several", allowed));
        }
        let is_way = has_way_points || motion.csv.is_some();
        if motion.interpolation.is_some() && !is_way {
            let given = format!(
                "interpolation beside {}",
                if has_phases { "phases" } else { "oscillation" }
            );
            return Err(self.check.error(key, given, "it only beside way-points"));
        }
        if has_phases {
            return self.phases(key, start, motion);
        }
        if let Some(oscillation) = oscillation {
            return self.oscillation(key, start, oscillation);
        }
        if *at != PoseSpec::default() {
            let given = "way-points beside `at`";
            let allowed = "one of them: way-points replace it";
            return Err(self.check.error(key, given, allowed));
        }
        let interpolation = motion.interpolation.unwrap_or_default();
        let trajectory = match &motion.csv {
            Some(path) => {
                let (place, file) = self.open(&format!("{key}.csv"), path)?;
                PoseTrajectory::read_csv(&place, file, interpolation)
            }
            None => {
                let key = format!("{key}.way_points");
                let points = motion.way_points.iter();
                let times = points.clone().map(|point| point.time_s).collect();
                let rows = points.map(|point| {
                    let position = self.vector(&key, point.position_mm, MM)?;
                    Ok([
                        position,
                        self.vector(&key, point.rotation_deg, 1f64.to_radians())?,
                    ])
                });
                let rows = rows.collect::<Result<Vec<_>>>()?;
                PoseTrajectory::from_rpy(times, &rows, interpolation)
            }
        };
        Ok(Motion::WayPoints(self.under(key, trajectory)?))
    }

    fn oscillation(&self, key: &str, start: Pose, spec: &OscillationSpec) -> Result<Motion> {
        let key = |name: &str| format!("{key}.oscillation.{name}");
        let degree = 1f64.to_radians();
        let period = spec.period_s;
        Ok(Motion::Oscillation(Oscillation {
            start,
            linear: self.vector(&key("linear_mm"), spec.linear_mm, MM)?,
            angular: self.vector(&key("angular_deg"), spec.angular_deg, degree)?,
            period: self
                .check
                .value(&key("period_s"), period, positive, "a positive number")?,
        }))
    }

    fn phases(&self, key: &str, start: Pose, motion: &MotionSpec) -> Result<Motion> {
        let key = &format!("{key}.phases");
        let mut phases = Vec::new();
        for phase in &motion.phases {
            let allowed = "zero or a positive number of seconds";
            phases.push(Phase {
                duration: self
                    .check
                    .value(key, phase.duration_s, not_negative, allowed)?,
                linear: self.vector(key, phase.linear_mm_per_s, MM)?,
                angular: self.vector(key, phase.angular_deg_per_s, 1f64.to_radians())?,
            });
        }
        Ok(Motion::Plan(
            self.under(key, VelocityPlan::new(start, phases))?,
        ))
    }
}
