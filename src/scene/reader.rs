//! Reading of a scene file for all parts of the plan: errors with file and key, names, motions, and files.

use super::planned::{PlannedPatch, PlannedRobot};
use super::spec::{MotionSpec, ObjectSpec, PoseSpec};
use super::spec_motion::MOTION_RULES;
use crate::error::Result;
use crate::inputs::check::Check;
use crate::objects::Model;
use crate::spelling::known;
use crate::world::{Motion, PoseTrajectory, VelocityPlan};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Reader that reads the files of a scene and checks how its keys fit together. The numbers of its keys have been checked before.
pub(crate) struct Reader<'a> {
    pub check: Check<'a>,
    /// Folder to which paths in the file are relative.
    pub folder: &'a Path,
    /// Objects given in memory, by their names in the scene.
    pub models: &'a BTreeMap<String, Model>,
    /// Objects of the scene.
    pub objects: &'a [ObjectSpec],
    /// Robots that have been read.
    pub robots: Vec<PlannedRobot>,
    /// Patches that have been read.
    pub patches: Vec<PlannedPatch>,
}

static NO_MODELS: BTreeMap<String, Model> = BTreeMap::new();

impl<'a> Reader<'a> {
    /// Creates a reader of a file without robots, patches and objects in memory.
    pub fn new(place: &'a str, folder: &'a Path) -> Self {
        Self {
            check: Check { place },
            folder,
            models: &NO_MODELS,
            objects: &[],
            robots: Vec::new(),
            patches: Vec::new(),
        }
    }

    /// Returns the error of a key, with the name of the file.
    pub fn refuse<T>(&self, key: &str, given: impl ToString, allowed: impl ToString) -> Result<T> {
        Err(self.check.error(key, given, allowed))
    }

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
                self.refuse(key, given, "a file, its path relative to the scene's")
            }
        }
    }

    /// Reads the file that a key names.
    pub fn read<T>(
        &self,
        key: &str,
        path: &Path,
        read: impl FnOnce(&Path) -> Result<T>,
    ) -> Result<T> {
        self.open(key, path)?;
        self.under(key, read(&self.path(path)))
    }

    /// Returns the motion of the body that is described under `key`, given its pose `at` and its optional imposed motion.
    pub fn motion(&self, key: &str, at: &PoseSpec, motion: Option<&MotionSpec>) -> Result<Motion> {
        let Some(motion) = motion else {
            return Ok(Motion::Fixed(at.pose()));
        };
        let key = &format!("{key}.motion");
        self.check.rules(key, motion, MOTION_RULES)?;
        if let Some(oscillation) = &motion.oscillation {
            return Ok(Motion::Oscillation(oscillation.about(at.pose())));
        }
        if !motion.phases.is_empty() {
            let phases = motion.phases.iter().map(|phase| phase.phase()).collect();
            let plan = VelocityPlan::new(at.pose(), phases);
            return Ok(Motion::Plan(self.under(&format!("{key}.phases"), plan)?));
        }
        if *at != PoseSpec::default() {
            let allowed = "one of them: way-points replace it";
            return self.refuse(key, "way-points beside `at`", allowed);
        }
        let interpolation = motion.interpolation.unwrap_or_default();
        let trajectory = match &motion.csv {
            Some(path) => {
                let (place, file) = self.open(&format!("{key}.csv"), path)?;
                PoseTrajectory::read_csv(&place, file, interpolation)
            }
            None => {
                let points = motion.way_points.iter();
                let times = points.clone().map(|point| point.time_s).collect();
                let rows: Vec<_> = points.map(|point| point.position_and_angles()).collect();
                PoseTrajectory::from_rpy(times, &rows, interpolation)
            }
        };
        Ok(Motion::WayPoints(self.under(key, trajectory)?))
    }
}
