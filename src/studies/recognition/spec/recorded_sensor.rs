//! Keys of one sensor of a recording: those of `[recorded]`, and those of each of `[[recorded.sensors]]`.

use crate::studies::recognition::spec::zero::ZeroSpec;
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
                frames_test: Option<PathBuf> => $crate::inputs::range::Range::Unchecked, Condition, Axes;
                /// Order of the array axes of the frames, one letter per axis: `n` touches, `t` frames of a touch, `y` rows, `x` columns, `c` values or taxels.
                /// If the frames have rows and columns, the axis `c` contains the values of a taxel, and each value has an image. Otherwise `c` contains the
                /// taxels. Default: `n y x`, `n t y x` or `n c`.
                order: Option<String> => $crate::inputs::range::Range::Unchecked, Condition, Axes;
                /// Numbers of rows and columns of the sensor, if the axis `c` of the frames lists its taxels row by row.
                grid: Option<[usize; 2]> => $crate::inputs::range::Range::Unchecked, Condition, Axes;
                /// Columns of a table (`.csv`, `.tsv`, `.txt`) that are readings: names or patterns, separated by commas, such as `taxel_*`. In a pattern, `*` stands
                /// for any text and `#` for a number. The taxels have the order of the columns in the file. Default: all columns, whose names may differ in numbers
                /// alone.
                columns: Option<String> => $crate::inputs::range::Range::Unchecked, Choice, Axes;
                /// Layout file with the position and the axis of each taxel, in the order of the taxels in the frames. Formats: `.csv`, `.npz`, `.txt` or
                /// `.ini` (iCub), `.json` (PaXini) or `.urdf`. Taxels that form a grid row by row are read as a grid. If one of several axes `c` counts the
                /// positions, the other axes count values at each position, such as events of two signs.
                layout: Option<PathBuf> => $crate::inputs::range::Range::Unchecked, Condition, Axes;
                /// File with the number of frames of each touch, shape (n,), from 1 to the number of frames in the array. Without this key, frames at the end of a touch
                /// in which all readings are NaN are missing. Touches of unequal length need `resampled_frames`.
                lengths: Option<PathBuf> => $crate::inputs::range::Range::Unchecked, Condition, Axes;
                /// File with the number of frames of each touch of the separate test set, in the format of `lengths`.
                lengths_test: Option<PathBuf> => $crate::inputs::range::Range::Unchecked, Condition, Axes;
                /// Reading of an untouched taxel: one number, or a file with one number per taxel. Default: 0.
                zero: ZeroSpec = ZeroSpec::default() => $crate::inputs::range::Range::Finite, Condition, Axes;
                /// Reading of a taxel at full scale, where the deflection equals the stroke. Default: the largest reading of the sensor.
                full_scale: Option<f64> => $crate::inputs::range::Range::Finite, Condition, Axes;
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
