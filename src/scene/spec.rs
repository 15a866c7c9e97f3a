//! Specification of a scene: the keys of its TOML file, in the units of the keys.
//!
//! Only names and types are checked here; [`ScenePlan`](super::ScenePlan) checks the values.

pub use super::numbers::Numbers;
pub use super::spec_motion::*;
pub use super::spec_object::*;
pub use super::spec_patch::*;
use crate::error::Result;
use crate::files::FilePath;
use crate::toml_text;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Specification of a scene. Paths are relative to the folder of the scene file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneSpec {
    /// Description of the scene, one sentence.
    pub title: String,
    /// Maximum time step, ms. The time between two frames is divided into equal steps of at most this length; any length is stable.
    #[serde(default = "one")]
    pub dt_ms: f64,
    /// Number of frames per second of scene time.
    #[serde(default = "hundred")]
    pub output_hz: f64,
    /// Duration of the scene. Default: until the last imposed motion ends.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    /// Gravitational acceleration, world frame, m/s².
    #[serde(default = "earth")]
    pub gravity_m_per_s2: [f64; 3],
    /// Seed of all random numbers, such as the start of a draped layout.
    #[serde(default = "seed")]
    pub seed: u64,
    /// Robots: `[[robots]]`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub robots: Vec<RobotSpec>,
    /// Patches of skin: `[[patches]]`.
    pub patches: Vec<PatchSpec>,
    /// Objects: `[[objects]]`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub objects: Vec<ObjectSpec>,
    /// Planes: `[[planes]]`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub planes: Vec<PlaneSpec>,
}

/// Rigid plane: `[[planes]]`. Free objects do not enter its half-space, for example a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneSpec {
    /// Name, unique in the scene.
    pub name: String,
    /// Point on the surface, world frame.
    #[serde(default)]
    pub point_mm: [f64; 3],
    /// Outward normal, world frame, of any length.
    #[serde(default = "up")]
    pub normal: [f64; 3],
}

/// Robot that carries patches or objects: `[[robots]]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotSpec {
    /// Name, unique in the scene.
    pub name: String,
    /// Path of the robot's URDF file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<String>")]
    pub urdf: Option<FilePath>,
    /// Robot of one link without joints, in place of `urdf`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub floating: bool,
    /// Pose, or initial pose, of the base.
    #[serde(default)]
    pub at: PoseSpec,
    /// Motion of the base. Default: no motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionSpec>,
    /// Joint positions. A joint that is not listed stays at 0, or at the nearest limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joints: Option<JointsSpec>,
}

impl SceneSpec {
    /// Parses the text of a scene file.
    ///
    /// # Errors
    /// If the text is not a valid scene; the error contains the file, the line and the key.
    pub fn parse(place: &str, text: &str) -> Result<Self> {
        toml_text::read(place, text)
    }

    /// Returns whether the text contains `rpy_deg`, the old name of `rotation_deg`, which is still read.
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

    /// Returns the scene as TOML, including default values.
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
