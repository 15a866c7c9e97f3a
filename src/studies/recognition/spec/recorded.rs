//! Specification of recorded frames: the table `[recorded]`, which replaces `[objects]` and `[touches]`.

use crate::inputs::arrays::axis_order::{FrameAxes, FrameShape, frame_shape, spaced};
use crate::inputs::arrays::{FileArray, TableContent, is_member};
use crate::inputs::keys::Acts;
use crate::inputs::layout_file::{LayoutFile, LayoutOptions};
use crate::inputs::params::is_default;
use crate::inputs::range::Range::{Any, Count, NotNegative, Positive, Unchecked};
use crate::inputs::units::MAX_FRAMES;
use crate::studies::prelude::*;
use crate::studies::recognition::spec::{
    OF_TEST_SET, RecordedSensorSpec, SensorChoice, SensorPlace, ZeroSpec, sensor_spec, sensor_table,
};
use std::path::{Path, PathBuf};

/// Condition of the keys of `[recorded]` that each of several sensors has in a table of its own.
pub(super) const OF_EACH_SENSOR: &[Acts] = acts![RecordedSpec: |recorded| recorded.sensors.is_empty()
    => "", "this key in each of [[recorded.sensors]]"];

sensor_spec! {
    /// Keys of `[recorded]`: frames that a real skin recorded, in NumPy files (`.npy`, `.npz`) or tables (`.csv`). The table `[skin]` gives the pitch and the
    /// stroke of the taxels. `frames` contains the frames of one sensor; `[[recorded.sensors]]` lists several sensors that recorded the same touches.
    pub struct RecordedSpec {
        /// File with the frames. Its shape is (n, rows, columns), (n, F, rows, columns) for F frames per touch, or (n, taxels) without rows and columns.
        /// Any numeric type of up to 64 bits. If this file is an archive that contains the other arrays, their keys may be omitted.
        #[serde(skip_serializing_if = "is_default")]
        frames: PathBuf = PathBuf::new() => Unchecked, Condition, Axes, acts: OF_EACH_SENSOR;
        /// File with the tangential forces of a skin that reads shear, newtons: two forces across the axis of each taxel. The array has the axes of `frames` plus
        /// an axis `c` of length 2 before the rows and columns. Without this key, `frames` contains all three values of each taxel.
        shear: Option<PathBuf> => Unchecked, Condition, Axes;
        /// File of the class of every touch: integers or texts, shape (n,), or entries 0 and 1, shape (n, classes).
        #[serde(skip_serializing_if = "is_default")]
        labels: PathBuf = PathBuf::new() => Unchecked, Condition, Axes;
        /// File with the group of every touch, such as its grasp or day, shape (n,). A split never divides a group.
        groups: Option<PathBuf> => Unchecked, Condition, Axes;
        /// Archive `.npz` with the split of each trial t: arrays `train_t` and `test_t` of touch numbers from 0, or of a bool for each touch. Touches in neither
        /// array are not used. Replaces `test_fraction` and `folds`.
        splits: Option<PathBuf> => Unchecked, Condition, Axes,
            acts: acts![RecordedSpec: |recorded| !recorded.has_test_set() => "", OF_TEST_SET];
        /// Number F of frames to which each touch is resampled, at least 1. Frames are interpolated linearly at F instants, evenly spaced from the first to
        /// the last frame. If F is 1, the last frame is used. Default: all frames.
        resampled_frames: Option<usize> => Count(1, MAX_FRAMES), Choice, Axes;
        /// Sensors that recorded the same touches, instead of `frames`. Their readings are joined to one frame, each with its own zero and full scale.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        sensors: Vec<RecordedSensorSpec> = Vec::new() => Unchecked, Condition, Axes;
        /// Sensors whose readings the study uses: `all` (default), a name of `sensors`, several names joined by `+`, or a list of names.
        sensor: Option<SensorChoice> => Any, Choice, Axes;
        /// File with the tangential forces of the separate test set, newtons, in the format of `shear`.
        shear_test: Option<PathBuf> => Unchecked, Condition, Axes;
        /// File with the classes of the separate test set, in the format of `labels`.
        labels_test: Option<PathBuf> => Unchecked, Condition, Axes;
        /// File with the groups of the separate test set, in the format of `groups`. The interval of the accuracy is computed over these groups.
        groups_test: Option<PathBuf> => Unchecked, Condition, Axes;
        /// Names of the classes, in the order of their numbers from 0.
        names: Option<Vec<String>> => Unchecked, Condition, Axes;
        /// File with the press depth of each touch, metres, shape (n,). Together with `speed_mm_per_s`, it determines the time between the frames of a touch.
        depths: Option<PathBuf> => Unchecked, Condition, Axes;
        /// Speed of the skin towards the object when it was read, mm/s, at least 0; the speed affects the damper force. Default: 0.
        #[serde(skip_serializing_if = "is_default")]
        speed_mm_per_s: f64 = 0.0 => NotNegative, Condition, Axes;
        /// Time between the frames of a touch, s, for sensor errors that depend on time; replaces `speed_mm_per_s`.
        frame_interval_s: Option<f64> => Positive, Condition, Axes;
        /// Rule that determines the preceding touch of each touch, for sensor errors with memory. Values: `random` (default) or `none`.
        #[serde(skip_serializing_if = "is_default")]
        previous_touch: PreviousTouch = PreviousTouch::default() => Any, Condition, Axes;
    }
    unread {
        /// Number of values per taxel in the frames. The plan sets it, not the study file; 0 counts as 1.
        n_values: usize;
        /// Properties of the sensor if the specification describes one of several sensors. The plan sets them, not the study file.
        place: SensorPlace;
    }
}

words! {
    /// Rule that determines the touch before each touch, for sensor errors with memory, such as hysteresis.
    pub enum PreviousTouch = Random {
        /// The preceding touch is another touch of the study, drawn at random in each trial.
        Random = "random",
        /// No touch precedes any touch of the recording.
        None = "none",
    }
}

impl RecordedSpec {
    /// Returns a specification of frames without labels, for commands whose options are the keys `order`, `columns` and `grid`.
    pub fn of_frames(
        frames: &Path,
        [order, columns]: [&Option<String>; 2],
        grid: Option<[usize; 2]>,
    ) -> Self {
        Self {
            frames: frames.to_owned(),
            order: order.clone(),
            columns: columns.clone(),
            grid,
            place: SensorPlace {
                is_of_command: true,
                ..SensorPlace::default()
            },
            ..Self::default()
        }
    }

    /// Calls `change` with the key and the path of each file of the recording. `change` may replace the path.
    pub fn change_files(&mut self, mut change: impl FnMut(&str, &mut PathBuf)) {
        self.change_sensor_files("recorded", &mut change);
        let files = [
            (
                "labels",
                Some(&mut self.labels).filter(|path| !is_default(*path)),
            ),
            ("groups", self.groups.as_mut()),
            ("splits", self.splits.as_mut()),
            ("shear", self.shear.as_mut()),
            ("labels_test", self.labels_test.as_mut()),
            ("groups_test", self.groups_test.as_mut()),
            ("shear_test", self.shear_test.as_mut()),
            ("depths", self.depths.as_mut()),
        ];
        for (key, path) in files {
            if let Some(path) = path {
                change(&format!("recorded.{key}"), path);
            }
        }
        for (number, sensor) in self.sensors.iter_mut().enumerate() {
            sensor.change_sensor_files(&sensor_table(number), &mut change);
        }
    }

    /// Returns the file that contains the array `name`: the file given by its key, or the archive with the frames.
    pub fn file_of(&self, name: &str) -> Option<&Path> {
        let given = match name {
            "frames" => Some(&self.frames),
            "labels" => Some(&self.labels),
            "groups" => self.groups.as_ref(),
            "frames_test" => self.frames_test.as_ref(),
            "labels_test" => self.labels_test.as_ref(),
            "groups_test" => self.groups_test.as_ref(),
            "lengths" => self.lengths.as_ref(),
            "lengths_test" => self.lengths_test.as_ref(),
            _ => self.depths.as_ref(),
        };
        let given = given.filter(|path| !is_default(*path));
        let archive = self.frames.as_path();
        given.map(PathBuf::as_path).or_else(|| {
            let mut names = self.place.array_names(name).into_iter();
            let has_array = names.any(|name| is_member(archive, &name));
            has_array.then_some(archive)
        })
    }

    /// Returns the name of the array `name` in its file. In an archive with the arrays of several sensors, the name contains the name of the sensor.
    pub fn array_name(&self, name: &str) -> String {
        let path = self.frames_file(name);
        let names = self.place.array_names(name).into_iter();
        // A file of the test set alone may have the names of the training frames.
        let same_name = self.place.name.clone().filter(|_| path != self.frames);
        let found = names.chain(same_name).find(|name| is_member(path, name));
        found.unwrap_or_else(|| name.to_owned())
    }

    /// Returns the file that contains the array `frames` or `frames_test`; for several sensors, the file of the frames of the first sensor.
    pub fn frames_file(&self, name: &str) -> &Path {
        self.file_of(name).unwrap_or_else(|| self.first_frames())
    }

    /// Returns the names of the arrays of frames of a sensor: `frames` and, with a separate test set, `frames_test`.
    pub fn frame_arrays(&self) -> &'static [&'static str] {
        match self.file_of("frames_test") {
            Some(_) => &["frames", "frames_test"],
            None => &["frames"],
        }
    }

    /// Returns whether the recording has a separate test set.
    pub fn has_test_set(&self) -> bool {
        let sensors = self.used_sensors();
        let mut sensors = sensors.iter();
        sensors.any(|(_, sensor)| sensor.frame_arrays().len() > 1)
    }

    /// Returns the path of the frames, or of the frames of the first sensor.
    pub fn first_frames(&self) -> &Path {
        match self.sensors.first() {
            Some(sensor) => &sensor.frames,
            None => &self.frames,
        }
    }

    /// Returns the axes and their lengths of the array `frames` or `frames_test`.
    ///
    /// # Errors
    /// If the file does not exist or its axes are not axes of frames.
    pub fn shape_of(&self, name: &str) -> Result<FrameShape> {
        let path = self.frames_file(name);
        let shape = self.with_frames(name, FileArray::shape_of)?;
        let n_values = match self.shear {
            Some(_) => 1,
            None => self.n_values.max(1),
        };
        let key = self.place.key("order");
        let axes = self.axes(self.order.as_deref(), n_values, &key);
        let found = frame_shape(&path.display().to_string(), &shape, axes)?;
        match &self.layout {
            Some(layout) if found.has_several_taxel_axes() => {
                let layout = LayoutFile::read(layout, LayoutOptions::default())?.layout;
                Ok(found.with_places(layout.n_taxels()))
            }
            _ => Ok(found),
        }
    }

    /// Calls a function that reads the array `frames` or `frames_test`, given its path, its name in an archive, and its content.
    ///
    /// # Errors
    /// Returns the errors of the function.
    pub fn with_frames<T>(
        &self,
        name: &str,
        read: impl FnOnce(&Path, &str, TableContent) -> Result<T>,
    ) -> Result<T> {
        let content = TableContent::Frames {
            columns: self.columns.as_deref(),
            key: &self.place.assigned("columns"),
        };
        read(self.frames_file(name), &self.array_name(name), content)
    }

    /// Returns the readings of untouched taxels, shape (n_taxels,), in row-major order.
    ///
    /// # Errors
    /// If the file cannot be read or does not have one number for each taxel of `shape`, the axes of `frames`, whose columns have the names `columns`.
    pub fn zeros(&self, shape: &FrameShape, columns: Option<&[String]>) -> Result<Vec<f64>> {
        let path = match &self.zero {
            ZeroSpec::One(number) => return Ok(vec![*number; shape.n_taxels]),
            ZeroSpec::Each(path) => path,
        };
        let array = FileArray::read(path, "zero")?;
        array.check_columns_of(columns, &self.frames.display().to_string())?;
        let (place, given) = (array.place.clone(), array.shape.clone());
        let zeros = shape.arrange_taxels(array.into_numbers()?);
        zeros.map_err(|expected| {
            let frames = self.frames.display();
            let allowed = format!("shape {expected:?}, one number for each taxel of {frames}");
            Error::input(place, format!("an array of shape {given:?}"), allowed)
        })
    }

    fn axes<'a>(&self, order: Option<&'a str>, n_values: usize, key: &'a str) -> FrameAxes<'a> {
        FrameAxes {
            order,
            grid: self.grid,
            n_values,
            key,
        }
    }

    /// Returns the file with the tangential forces of the array `frames` or `frames_test`, and the name of the array in this file.
    pub fn shear_of(&self, name: &str) -> Option<(&Path, &'static str)> {
        let (path, name) = match name {
            "frames" => (&self.shear, "shear"),
            _ => (&self.shear_test, "shear_test"),
        };
        Some((path.as_deref()?, name))
    }

    /// Returns the axes of the tangential forces that belong to `frames` or `frames_test`, given the axes of the frames. Returns `None` if there is no such
    /// file.
    ///
    /// # Errors
    /// If the axes differ from the axes of the frames with two values per taxel.
    pub fn shear_shape(&self, name: &str, frames: &FrameShape) -> Result<Option<FrameShape>> {
        let Some((path, array)) = self.shear_of(name) else {
            return Ok(None);
        };
        let (order, expected) = frames.beside(2);
        let shape = FileArray::shape_of(path, array, TableContent::Any)?;
        let place = path.display().to_string();
        if shape != expected {
            let given = format!("an array of shape {shape:?}");
            let allowed = format!(
                "shape {expected:?} (\"{}\"): the axes of {}, and two forces of each taxel",
                spaced(&order),
                self.frames_file(name).display()
            );
            return Err(Error::input(place, given, allowed));
        }
        let axes = self.axes(Some(&order), 2, "recorded.order");
        frame_shape(&place, &shape, axes).map(Some)
    }

    /// Checks that the files form a complete data set.
    ///
    /// # Errors
    /// If there are no labels, or a test set lacks labels or frames. If tangential forces are given although the skin does not read shear, or for only one of
    /// two sets.
    pub fn check_files(&self) -> Result<()> {
        self.check_sensors()?;
        if self.file_of("labels").is_none() {
            // A file that cannot be read has no labels either.
            for (_, sensor) in self.used_sensors() {
                sensor.shape_of("frames")?;
            }
            let allowed = "labels = \"FILE\", the class of every touch (or an array `labels` in the archive of the frames)";
            return Err(Error::input("key recorded.labels", "no such key", allowed));
        }
        let has = |name| self.file_of(name).is_some();
        let refuse = |key: &str, given: &str, allowed: &str| {
            Err(Error::input(format!("key recorded.{key}"), given, allowed))
        };
        let sensors = self.used_sensors();
        let is_without = |(_, sensor): &&(String, Self)| sensor.frame_arrays().len() == 1;
        let (frames, labels) = (self.has_test_set(), has("labels_test"));
        if let (true, Some((_, sensor))) = (frames, sensors.iter().find(is_without)) {
            let key = format!("key {}", sensor.place.key("frames_test"));
            let allowed = "frames of the test set, as other sensors have";
            return Err(Error::input(key, "no such key", allowed));
        }
        for (key, path) in [("shear", &self.shear), ("shear_test", &self.shear_test)] {
            if let (Some(path), ..=1) = (path, self.n_values) {
                let allowed = "no such key without skin.sensed = \"shear\"";
                return refuse(key, &path.display().to_string(), allowed);
            }
        }
        match (frames, &self.shear, &self.shear_test) {
            (true, Some(_), None) => {
                let given = "no such key beside shear and frames_test";
                let allowed =
                    "the forces across of frames_test, as recorded.shear has those of frames";
                return refuse("shear_test", given, allowed);
            }
            (_, None, Some(path)) | (false, _, Some(path)) => {
                let allowed = "no such key without recorded.shear and recorded.frames_test";
                return refuse("shear_test", &path.display().to_string(), allowed);
            }
            _ => {}
        }
        match (frames, labels, has("groups_test")) {
            (true, false, _) => {
                let allowed = "the class of every touch of the test set";
                refuse("labels_test", "no such key beside frames_test", allowed)
            }
            (false, true, _) | (false, _, true) => {
                let given = "no such key beside labels_test or groups_test";
                refuse("frames_test", given, "the frames of the test set")
            }
            _ => Ok(()),
        }
    }
}
