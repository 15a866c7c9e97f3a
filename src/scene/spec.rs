//! Specification of a scene: the keys of its TOML file, in the file's units.
//!
//! The specification checks only names and types. The scene plan checks the values.

pub use super::numbers::Numbers;
pub use super::spec_motion::*;
pub use super::spec_object::*;
pub use super::spec_patch::*;
use crate::error::Result;
use crate::files::FilePath;
use crate::toml_text;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Contents of a scene file. Paths are relative to the folder of the scene file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneSpec {
    /// Description of the scene in one sentence, for reports.
    pub title: String,
    /// Maximum time step, ms, positive. Default: 1. The time between two frames is divided into equal steps of at most this length; any length is stable.
    #[serde(default = "one")]
    pub dt_ms: f64,
    /// Number of frames per second of scene time, Hz, positive. Default: 100.
    #[serde(default = "hundred")]
    pub output_hz: f64,
    /// Duration of the scene, s. Default: until the last imposed motion ends.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    /// Gravitational acceleration in the world frame, m/s². Default: (0, 0, −9.81).
    #[serde(default = "earth")]
    pub gravity_m_per_s2: [f64; 3],
    /// Seed of all random numbers, such as sensor noise and the start of a draped layout. Default: 2018.
    #[serde(default = "seed")]
    pub seed: u64,
    /// Tables `[[robots]]` of the scene file: robots that carry patches or objects.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub robots: Vec<RobotSpec>,
    /// Tables `[[patches]]` of the scene file: patches of skin.
    pub patches: Vec<PatchSpec>,
    /// Tables `[[objects]]` of the scene file: objects that touch the skin.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub objects: Vec<ObjectSpec>,
    /// Tables `[[planes]]` of the scene file: rigid planes, such as tables.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub planes: Vec<PlaneSpec>,
}

/// Keys of `[[planes]]`: a rigid plane, such as a table. Free objects do not enter its half-space.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneSpec {
    /// Name of the plane, unique in the scene.
    pub name: String,
    /// Point on the plane, world frame, mm. Default: the origin.
    #[serde(default)]
    pub point_mm: [f64; 3],
    /// Outward normal of the plane, world frame, of any length. Default: +z.
    #[serde(default = "up")]
    pub normal: [f64; 3],
}

/// Keys of `[[robots]]`: a robot that carries patches or objects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotSpec {
    /// Name of the robot, unique in the scene.
    pub name: String,
    /// Path of the robot's file, URDF or MJCF (MuJoCo), relative to the scene file. In MJCF each body is a link, and each site with a name is a link that is
    /// fixed to its body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<String>")]
    pub file: Option<FilePath>,
    /// Another name of `file`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<String>")]
    pub urdf: Option<FilePath>,
    /// Folders of packages by their names, for meshes at `package://NAME/…`, such as `packages = { my_robot = "../my_robot" }`. Default: a package is searched in
    /// the folders above the robot's file.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(with = "BTreeMap<String, String>")]
    pub packages: BTreeMap<String, FilePath>,
    /// Whether the robot consists of one link without joints; replaces `file`. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub floating: bool,
    /// Pose of the robot's base, or its initial pose if it moves. Default: the world origin.
    #[serde(default)]
    pub at: PoseSpec,
    /// Imposed motion of the robot's base. Default: no motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionSpec>,
    /// Joint positions of the robot over time. A joint that is not listed stays at its default position: in URDF at 0 or at the nearest limit, in MJCF at `ref`.
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

    /// Returns the scene as TOML text that contains all default values.
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
