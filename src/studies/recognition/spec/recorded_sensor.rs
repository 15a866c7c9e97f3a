//! Specification of one of several sensors of a recording: `[[recorded.sensors]]`.

use crate::files::{file_path, optional_file_path};
use crate::studies::recognition::spec::zero::ZeroSpec;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Keys of `[[recorded.sensors]]`: one of several sensors that recorded the same touches, such as the fingertips of a hand.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RecordedSensorSpec {
    /// Name of the sensor; each name once, not `all`.
    pub name: String,
    /// File with the frames of the sensor, in the format of `recorded.frames`. All sensors have the same touches in the same order. In an archive, the array
    /// with the name of the sensor is read if it exists.
    #[serde(deserialize_with = "file_path")]
    pub frames: PathBuf,
    /// File with the frames of the separate test set (in an archive, the array with the sensor's name and `_test`).
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "optional_file_path"
    )]
    pub frames_test: Option<PathBuf>,
    /// Order of the array axes of the frames, in the format of `recorded.order`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<String>,
    /// Numbers of rows and columns of the sensor, in the format of `recorded.grid`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<[usize; 2]>,
    /// File with the positions of the taxels, in the format of `recorded.layout`.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "optional_file_path"
    )]
    pub layout: Option<PathBuf>,
    /// Side of the square area per taxel of the sensor, mm, positive. Default: `skin.pitch_mm`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pitch_mm: Option<f64>,
    /// File with the number of frames of each touch, in the format of `recorded.lengths`.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "optional_file_path"
    )]
    pub lengths: Option<PathBuf>,
    /// File with the number of frames of each touch of the separate test set.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "optional_file_path"
    )]
    pub lengths_test: Option<PathBuf>,
    /// Reading of an untouched taxel of the sensor, in the format of `recorded.zero`. Default: 0.
    #[serde(default)]
    pub zero: ZeroSpec,
    /// Reading of a taxel of the sensor at full scale. Default: the largest reading of the sensor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub full_scale: Option<f64>,
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
}

impl SensorPlace {
    /// Returns the name of a key of the sensor, such as `recorded.sensors[1].order`.
    pub fn key(&self, key: &str) -> String {
        match self.table.is_empty() {
            true => format!("recorded.{key}"),
            false => format!("{}.{key}", self.table),
        }
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

impl RecordedSensorSpec {
    /// Returns the paths of all files of the sensor.
    pub(super) fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        let others = [
            &self.frames_test,
            &self.layout,
            &self.lengths,
            &self.lengths_test,
        ];
        let files = [Some(&self.frames), self.zero.path()];
        files
            .into_iter()
            .chain(others.map(Option::as_ref))
            .flatten()
    }

    /// Returns mutable references to the paths of all files of the sensor.
    pub(super) fn paths_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        let others = [
            &mut self.frames_test,
            &mut self.layout,
            &mut self.lengths,
            &mut self.lengths_test,
        ];
        let files = [Some(&mut self.frames), self.zero.path_mut()];
        files
            .into_iter()
            .chain(others.map(Option::as_mut))
            .flatten()
    }
}
