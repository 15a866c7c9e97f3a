//! Sensors of a recording: the keys of one sensor, which are those of `[recorded]` and of each of `[[recorded.sensors]]`, and the sensors that a study uses.

use crate::files::file_path;
use crate::inputs::params::variants;
use crate::studies::prelude::*;
use std::path::PathBuf;

/// Defines the specification of a sensor: the given keys, followed by the keys that `[recorded]` and `[[recorded.sensors]]` share. The method
/// `change_sensor_files` changes the paths among the shared keys.
macro_rules! sensor_spec {
    ($(#[doc = $about:literal])* pub struct $name:ident { $($keys:tt)* } $(unread { $($unread:tt)* })?) => {
        $crate::inputs::params::params! {
            $(#[doc = $about])*
            #[derive(Default)]
            pub struct $name {
                $($keys)*
                /// File with the frames of a separate test set, with the array axes of `frames`; all touches of `frames` are then training touches. In an archive, the
                /// array `frames_test`, or the array with the sensor's name and `_test`, is read if it exists.
                frames_test: Option<PathBuf> => $crate::inputs::range::Range::Unchecked, Condition, Axes, acts: $crate::studies::recognition::spec::recorded::OF_EACH_SENSOR;
                /// Order of the array axes of the frames, one letter per axis: `n` touches, `t` frames of a touch, `y` rows, `x` columns, `c` values or taxels.
                /// If the frames have rows and columns, the axis `c` contains the values of a taxel, and each value has an image. Otherwise `c` contains the
                /// taxels. Default: `n y x`, `n t y x` or `n c`.
                order: Option<String> => $crate::inputs::range::Range::Unchecked, Condition, Axes, acts: $crate::studies::recognition::spec::recorded::OF_EACH_SENSOR;
                /// Numbers of rows and columns of the sensor, if the axis `c` of the frames lists its taxels row by row.
                grid: Option<[usize; 2]> => $crate::inputs::range::Range::Unchecked, Condition, Axes, acts: $crate::studies::recognition::spec::recorded::OF_EACH_SENSOR;
                /// Columns of a table (`.csv`, `.tsv`, `.txt`) that are readings: names or patterns, separated by commas, such as `taxel_*`. In a pattern, `*` stands
                /// for any text and `#` for a number. The taxels have the order of the columns in the file. Default: all columns, whose names may differ in numbers
                /// alone.
                columns: Option<String> => $crate::inputs::range::Range::Unchecked, Choice, Axes, acts: $crate::studies::recognition::spec::recorded::OF_EACH_SENSOR;
                /// Layout file with the position and the axis of each taxel, in the order of the taxels in the frames. Formats: `.csv`, `.npz`, `.txt` or
                /// `.ini` (iCub), `.json` (PaXini) or `.urdf`. Taxels that form a grid row by row are read as a grid. If one of several axes `c` counts the
                /// positions, the other axes count values at each position, such as events of two signs.
                layout: Option<PathBuf> => $crate::inputs::range::Range::Unchecked, Condition, Axes, acts: $crate::studies::recognition::spec::recorded::OF_EACH_SENSOR;
                /// File with the number of frames of each touch, shape (n,), from 1 to the number of frames in the array. Without this key, frames at the end of a touch
                /// in which all readings are NaN are missing. Touches of unequal length need `resampled_frames`.
                lengths: Option<PathBuf> => $crate::inputs::range::Range::Unchecked, Condition, Axes, acts: $crate::studies::recognition::spec::recorded::OF_EACH_SENSOR;
                /// File with the number of frames of each touch of the separate test set, in the format of `lengths`.
                lengths_test: Option<PathBuf> => $crate::inputs::range::Range::Unchecked, Condition, Axes, acts: $crate::studies::recognition::spec::recorded::OF_EACH_SENSOR;
                /// Reading of an untouched taxel: one number, or a file with one number per taxel. Default: 0.
                zero: ZeroSpec = ZeroSpec::default() => $crate::inputs::range::Range::Finite, Condition, Axes, acts: $crate::studies::recognition::spec::recorded::OF_EACH_SENSOR;
                /// Reading of a taxel at full scale, where the deflection equals the stroke. Default: the largest reading of the sensor.
                full_scale: Option<f64> => $crate::inputs::range::Range::Finite, Condition, Axes, acts: $crate::studies::recognition::spec::recorded::OF_EACH_SENSOR;
            }
            $(unread { $($unread)* })?
        }

        impl $name {
            /// Calls `change` with the key and the path of each file among the shared keys. `table` is the name of the table with the keys.
            pub(super) fn change_sensor_files(
                &mut self,
                table: &str,
                change: &mut impl FnMut(&str, &mut PathBuf),
            ) {
                let files = [
                    ("frames", Some(&mut self.frames).filter(|path| !path.as_os_str().is_empty())),
                    ("frames_test", self.frames_test.as_mut()),
                    ("layout", self.layout.as_mut()),
                    ("lengths", self.lengths.as_mut()),
                    ("lengths_test", self.lengths_test.as_mut()),
                    ("zero", self.zero.path_mut()),
                ];
                for (key, path) in files {
                    if let Some(path) = path {
                        change(&format!("{table}.{key}"), path);
                    }
                }
            }
        }
    };
}

pub(super) use sensor_spec;

sensor_spec! {
    /// Keys of `[[recorded.sensors]]`: one of several sensors that recorded the same touches, such as the fingertips of a hand.
        pub struct RecordedSensorSpec {
        /// Name of the sensor; each name once, not `all`.
        name: String;
        /// File with the frames of the sensor, in the format of `recorded.frames`. All sensors have the same touches in the same order. In an archive, the array
        /// with the name of the sensor is read if it exists.
        frames: PathBuf;
        /// Side of the square area per taxel of the sensor, mm, positive. Default: `skin.pitch_mm`.
        pitch_mm: Option<f64>;
    }
}

/// Properties of one sensor that the plan sets, not the study file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SensorPlace {
    /// Name of the table with the keys of the sensor, such as `recorded.sensors[1]`; empty for `recorded`.
    pub table: String,
    /// Side of the square area per taxel, mm; `None` for the pitch of the skin.
    pub pitch_mm: Option<f64>,
    /// Name of the sensor; `None` if the recording has one sensor without a name.
    pub name: Option<String>,
    /// Whether options of a command set the keys, such as `--order`.
    pub is_of_command: bool,
}

/// Returns the name of the table with the keys of a sensor, given the number of the sensor from 0.
pub(super) fn sensor_table(number: usize) -> String {
    format!("recorded.sensors[{}]", number + 1)
}

impl SensorPlace {
    /// Returns the name of a key of the sensor, such as `recorded.sensors[1].order`, or of the option of a command that sets the key.
    pub fn key(&self, key: &str) -> String {
        match (self.is_of_command, self.table.is_empty()) {
            (true, _) => format!("--{key}"),
            (false, true) => format!("recorded.{key}"),
            (false, false) => format!("{}.{key}", self.table),
        }
    }

    /// Returns the text that precedes the value of a key, such as `recorded.columns = `.
    pub(super) fn assigned(&self, key: &str) -> String {
        let equals = if self.is_of_command { "" } else { "= " };
        format!("{} {equals}", self.key(key))
    }

    /// Returns the names that the array `array` may have in the archive of the frames, the preferred name first. Frames have the name of the sensor, and its test
    /// frames the name followed by `_test`.
    pub(super) fn array_names(&self, array: &str) -> Vec<String> {
        let own = match (&self.name, array) {
            (Some(name), "frames") => Some(name.clone()),
            (Some(name), "frames_test") => Some(format!("{name}_test")),
            _ => None,
        };
        own.into_iter().chain([array.to_owned()]).collect()
    }
}

/// Value of `recorded.sensor` that selects all sensors.
const ALL: &str = "all";
/// Character between the names of several sensors in a text.
const AND: char = '+';

variants! {
    /// Sensors whose readings a study uses, such as `"all"`, `"palm"`, `"palm+thumb"` or `["palm", "thumb"]`.
    #[serde(expecting = "expected the name of a sensor, names joined by `+`, a list of names, or `all`")]
    pub untagged enum SensorChoice, Deserialize {
        /// `all`, a name, or names joined by `+`.
        Text(String),
        /// List of names.
        Names(Vec<String>),
    }
}

impl SensorChoice {
    /// Returns the chosen names; `None` for all sensors. A text that is the name of a sensor is one name.
    fn names(&self, known: &[RecordedSensorSpec]) -> Option<Vec<&str>> {
        match self {
            Self::Text(text) if text == ALL => None,
            Self::Text(text) if known.iter().any(|sensor| sensor.name == *text) => Some(vec![text]),
            Self::Text(text) => Some(text.split(AND).map(str::trim).collect()),
            Self::Names(names) => Some(names.iter().map(String::as_str).collect()),
        }
    }

    /// Returns the value as in a study file.
    fn words(&self) -> String {
        match self {
            Self::Text(text) => format!("{text:?}"),
            Self::Names(names) => format!("{names:?}"),
        }
    }
}

impl RecordedSpec {
    /// Returns the name and the specification of each sensor that the study uses. A recording without `sensors` is one sensor with the name `skin`. The
    /// specification of a sensor contains its own files, and the labels and groups of the recording.
    pub fn used_sensors(&self) -> Vec<(String, Self)> {
        if self.sensors.is_empty() {
            return vec![("skin".to_owned(), self.clone())];
        }
        let chosen = self.chosen_sensors();
        let is_used = |sensor: &RecordedSensorSpec| match &chosen {
            None => true,
            Some(names) => names.contains(&&sensor.name[..]),
        };
        let numbered = self.sensors.iter().enumerate();
        let used = numbered.filter(|(_, sensor)| is_used(sensor));
        let one = |(number, sensor): (usize, &RecordedSensorSpec)| {
            let sensor = sensor.clone();
            let spec = Self {
                frames: sensor.frames,
                frames_test: sensor.frames_test,
                order: sensor.order,
                grid: sensor.grid,
                columns: sensor.columns,
                layout: sensor.layout,
                lengths: sensor.lengths,
                lengths_test: sensor.lengths_test,
                zero: sensor.zero,
                full_scale: sensor.full_scale,
                sensors: Vec::new(),
                sensor: None,
                place: SensorPlace {
                    table: sensor_table(number),
                    pitch_mm: sensor.pitch_mm,
                    name: Some(sensor.name.clone()),
                    ..self.place.clone()
                },
                ..self.clone()
            };
            (sensor.name, spec)
        };
        used.map(one).collect()
    }

    /// Checks that the recording has either one array of frames or several sensors, and that the sensors have different names.
    ///
    /// # Errors
    /// If a key contradicts another one; the error contains the key.
    pub(super) fn check_sensors(&self) -> Result<()> {
        let refuse = |key: &str, given: String, allowed: &str| {
            Err(Error::input(format!("key recorded.{key}"), given, allowed))
        };
        if self.sensors.is_empty() {
            if self.frames.as_os_str().is_empty() {
                let allowed =
                    "frames = \"FILE\", or [[recorded.sensors]] with the frames of each sensor";
                return refuse("frames", "no such key".to_owned(), allowed);
            }
            return match &self.sensor {
                Some(choice) => {
                    let allowed = "no such key without [[recorded.sensors]]";
                    refuse("sensor", choice.words(), allowed)
                }
                None => Ok(()),
            };
        }
        if self.shear.is_some() || self.shear_test.is_some() || self.n_values > 1 {
            let allowed = "one value for each taxel: no shear and no skin.sensed = \"shear\"";
            return refuse("sensors", "sensors that read shear".to_owned(), allowed);
        }
        let names: Vec<&str> = self.sensors.iter().map(|s| &s.name[..]).collect();
        for (number, sensor) in self.sensors.iter().enumerate() {
            let key = |key: &str| format!("sensors[{}].{key}", number + 1);
            let name = &names[number];
            if name.is_empty() || *name == ALL || names[..number].contains(name) {
                let allowed = "a name that no other sensor has, and that is not `all`";
                return refuse(&key("name"), format!("{name:?}"), allowed);
            }
            if let Some(pitch) = sensor.pitch_mm
                && !(pitch.is_finite() && pitch > 0.0)
            {
                return refuse(&key("pitch_mm"), pitch.to_string(), "a positive number");
            }
            if let (Some(full_scale), ZeroSpec::One(zero)) = (sensor.full_scale, &sensor.zero)
                && (!full_scale.is_finite() || full_scale == *zero)
            {
                let allowed = format!("a number other than the zero, {zero}");
                return refuse(&key("full_scale"), full_scale.to_string(), &allowed);
            }
        }
        let chosen = self.chosen_sensors().unwrap_or_default();
        let is_wrong = |(number, name): (usize, &&str)| {
            !names.contains(name) || chosen[..number].contains(name)
        };
        match &self.sensor {
            Some(choice) if chosen.iter().enumerate().any(is_wrong) => {
                let several = match &names[..] {
                    [one, other, ..] => {
                        format!(", or several names, each once: \"{one}{AND}{other}\"")
                    }
                    _ => String::new(),
                };
                let allowed = format!("{ALL}, {}{several}", names.join(", "));
                refuse("sensor", choice.words(), &allowed)
            }
            _ => Ok(()),
        }
    }

    /// Returns the names of the sensors that `recorded.sensor` chooses; `None` for all sensors.
    fn chosen_sensors(&self) -> Option<Vec<&str>> {
        self.sensor.as_ref()?.names(&self.sensors)
    }
}

variants! {
    /// Readings of untouched taxels, written as `zero = 100.0` or `zero = "zero.npy"`.
    #[serde(expecting = "a number, or the path of a file with a number for each taxel")]
    pub untagged enum ZeroSpec, Deserialize {
        /// Common reading of all untouched taxels.
        One(f64),
        /// File with one reading for each taxel: an array with the taxel axes of `frames`, or a list in row-major order.
        #[serde(deserialize_with = "file_path")]
        Each(PathBuf),
    }
}

impl ZeroSpec {
    /// Returns a mutable reference to the path of the file with the readings; `None` for a common reading.
    pub fn path_mut(&mut self) -> Option<&mut PathBuf> {
        match self {
            Self::One(_) => None,
            Self::Each(path) => Some(path),
        }
    }
}

impl Default for ZeroSpec {
    fn default() -> Self {
        Self::One(0.0)
    }
}
