//! A study of breaking points as it is written.

use crate::inputs::objects_spec::ObjectsSpec;
use crate::studies::breaking_points::scale::WayScale;
use crate::studies::recognition::spec::scene::{SkinSpec, TouchesSpec};
use crate::studies::recognition::spec::signal::SignalSpec;
use crate::studies::recognition::spec::study::{RecognitionSpec, SensingSpec};
use crate::study_file::study_file;
use serde::{Deserialize, Serialize};

study_file! {
pub struct BreakingPointsSpec {
    /// How often each value is repeated with a new split, projection and noise.
    pub trials: usize,
    /// What is touched.
    pub objects: ObjectsSpec,
    /// What touches.
    pub skin: SkinSpec,
    /// How it touches.
    pub touches: TouchesSpec,
    /// What happens to a frame before it is sensed.
    #[serde(default)]
    pub signal: SignalSpec,
    /// How a frame is compressed.
    pub sensing: SensingSpec,
    /// How objects are recognised: any number of classifiers.
    pub recognition: RecognitionSpec,
    /// Ways to drive the study until it breaks.
    pub breaking_points: Vec<WaySpec>,
} }

/// `[[breaking_points]]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WaySpec {
    /// One word, as in tables and file names: letters, digits and `_`.
    pub name: String,
    /// What runs along x, with its unit.
    pub label: String,
    /// The keys of the study that take each value: `signal.noise_std_full_scale`.
    pub keys: Vec<String>,
    /// The values, ascending; at least three.
    pub values: Vec<toml::Value>,
    /// How places between values are measured.
    #[serde(default)]
    pub scale: WayScale,
    /// What a key makes of a value.
    #[serde(default, rename = "as")]
    pub driven_as: DrivenAs,
    /// Which touches have the value.
    #[serde(default)]
    pub touches: DrivenTouches,
    /// Other keys of the study, and their values along this way.
    #[serde(default, skip_serializing_if = "toml::Table::is_empty")]
    pub beside: toml::Table,
}

/// What a key makes of a value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DrivenAs {
    /// The value itself.
    #[default]
    Value,
    /// `{ uniform = [−value, value] }`; 0 for 0.
    HalfWidth,
}

/// Which touches have the value; the others have the study's own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DrivenTouches {
    /// All: what is tested has been learned alike.
    #[default]
    All,
    /// Those that train: what is tested is as it was.
    Training,
    /// Those that test: what is met was not learned.
    Test,
}
