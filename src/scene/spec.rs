//! A scene as it is written: the keys of its TOML file, in the units of its keys.
//!
//! Nothing is checked here beyond names and types; [`ScenePlan`](super::ScenePlan) does that.

pub use super::numbers::Numbers;
pub use super::spec_motion::*;
pub use super::spec_object::*;
pub use super::spec_patch::*;
use crate::error::Result;
use crate::files::FilePath;
use crate::toml_text;
use serde::{Deserialize, Serialize};

/// The file. Paths in it are relative to its folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneSpec {
    /// What happens, in a sentence.
    pub title: String,
    /// The longest step, ms. The time between two frames is cut into equal steps of at most this; any length is stable.
    #[serde(default = "one")]
    pub dt_ms: f64,
    /// Frames a second of the scene.
    #[serde(default = "hundred")]
    pub output_hz: f64,
    /// How long it lasts; until the last imposed motion ends when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    /// What pulls free objects, in the world.
    #[serde(default = "earth")]
    pub gravity_m_per_s2: [f64; 3],
    /// Root of all randomness: where draped taxels begin.
    #[serde(default = "seed")]
    pub seed: u64,
    /// `[[robots]]`
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub robots: Vec<RobotSpec>,
    /// `[[patches]]`
    pub patches: Vec<PatchSpec>,
    /// `[[objects]]`
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub objects: Vec<ObjectSpec>,
    /// `[[planes]]`
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub planes: Vec<PlaneSpec>,
}

/// `[[planes]]`: a table, or any half-space that free objects do not enter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneSpec {
    /// Its name in this scene.
    pub name: String,
    /// A point of its surface, in the world.
    #[serde(default)]
    pub point_mm: [f64; 3],
    /// Out of it, in the world; of any length.
    #[serde(default = "up")]
    pub normal: [f64; 3],
}

/// `[[robots]]`: what carries patches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotSpec {
    /// Its name in this scene.
    pub name: String,
    /// Its URDF file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub urdf: Option<FilePath>,
    /// Instead of `urdf`: one link without joints.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub floating: bool,
    /// Where its base is, or starts.
    #[serde(default)]
    pub at: PoseSpec,
    /// How its base moves; not at all when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionSpec>,
    /// Where its joints are. A joint that is not listed stands at 0, or at the nearest limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joints: Option<JointsSpec>,
}

impl SceneSpec {
    /// Reads a scene.
    ///
    /// # Errors
    /// The error names the file, the line and the key.
    pub fn parse(place: &str, text: &str) -> Result<Self> {
        toml_text::read(place, text)
    }

    /// Whether a text of a scene has a key by the name that `rotation_deg` had, which this version still reads: `rpy_deg`.
    pub fn has_old_names(text: &str) -> bool {
        fn is_old(value: &toml::Value) -> bool {
            match value {
                toml::Value::Table(table) => {
                    table.contains_key("rpy_deg") || table.values().any(is_old)
                }
                toml::Value::Array(values) => values.iter().any(is_old),
                _ => false,
            }
        }
        let table = toml_text::table(text);
        table.is_some_and(|table| is_old(&table.into()))
    }

    /// Writes the scene with its defaults spelt out.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("every field of a scene has a TOML form")
    }
}

fn up() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

fn one() -> f64 {
    1.0
}

fn hundred() -> f64 {
    100.0
}

fn earth() -> [f64; 3] {
    [0.0, 0.0, -9.81]
}

fn seed() -> u64 {
    2018
}
