//! Specification of a scene: the keys of its TOML file, in the file's units.
//!
//! The specification checks only names and types. The scene plan checks the values.

pub use super::spec_motion::*;
pub use super::spec_object::*;
pub use super::spec_patch::*;
use crate::error::Result;
use crate::files::FilePath;
use crate::inputs::check::Rule;
use crate::inputs::params::params;
use crate::inputs::range::Range::{NotNegative, Positive};
use crate::toml_text;
use std::collections::BTreeMap;

params! {
    /// Contents of a scene file. Paths are relative to the folder of the scene file.
    pub struct SceneSpec {
        /// Description of the scene in one sentence, for reports.
        title: String;
        /// Maximum time step, ms, positive. Default: 1. The time between two frames is divided into equal steps of at most this length; any length is stable.
        dt_ms: f64 = 1.0 => Positive;
        /// Number of frames per second of scene time, Hz, positive. Default: 100.
        output_hz: f64 = 100.0 => Positive;
        /// Duration of the scene, s. Default: until the last imposed motion ends.
        duration_s: Option<f64> => NotNegative;
        /// Gravitational acceleration in the world frame, m/s². Default: (0, 0, −9.81).
        gravity_m_per_s2: [f64; 3] = [0.0, 0.0, -9.81];
        /// Seed of all random numbers, such as sensor noise and the start of a draped layout. Default: 2018.
        seed: u64 = 2018;
        /// Tables `[[robots]]` of the scene file: robots that carry patches or objects.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        robots: Vec<RobotSpec> = Vec::new();
        /// Tables `[[patches]]` of the scene file: patches of skin.
        patches: Vec<PatchSpec>;
        /// Tables `[[objects]]` of the scene file: objects that touch the skin.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        objects: Vec<ObjectSpec> = Vec::new();
        /// Tables `[[planes]]` of the scene file: rigid planes, such as tables.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        planes: Vec<PlaneSpec> = Vec::new();
    }
}

params! {
    /// Keys of `[[planes]]`: a rigid plane, such as a table. Free objects do not enter its half-space.
    pub struct PlaneSpec {
        /// Name of the plane, unique in the scene.
        name: String;
        /// Point on the plane, world frame, mm. Default: the origin.
        point_mm: [f64; 3] = [0.0; 3];
        /// Outward normal of the plane, world frame, of any length. Default: +z.
        normal: [f64; 3] = [0.0, 0.0, 1.0];
    }
}

params! {
    /// Keys of `[[robots]]`: a robot that carries patches or objects.
    pub struct RobotSpec {
        /// Name of the robot, unique in the scene.
        name: String;
        /// Path of the robot's file, URDF or MJCF (MuJoCo), relative to the scene file. In MJCF each body is a link, and each site with a name is a link that is
        /// fixed to its body.
        file: Option<FilePath>;
        /// Another name of `file`.
        urdf: Option<FilePath>;
        /// Folders of packages by their names, for meshes at `package://NAME/…`, such as `packages = { my_robot = "../my_robot" }`. Default: a package is searched in
        /// the folders above the robot's file.
        #[serde(skip_serializing_if = "BTreeMap::is_empty")]
        packages: BTreeMap<String, FilePath> = BTreeMap::new();
        /// Whether the robot consists of one link without joints; replaces `file`. Default: false.
        #[serde(skip_serializing_if = "std::ops::Not::not")]
        floating: bool = false;
        /// Pose of the robot's base, or its initial pose if it moves. Default: the world origin.
        at: PoseSpec = PoseSpec::default();
        /// Imposed motion of the robot's base. Default: no motion.
        motion: Option<MotionSpec>;
        /// Joint positions of the robot over time. A joint that is not listed stays at its default position: in URDF at 0 or at the nearest limit, in MJCF at `ref`.
        joints: Option<JointsSpec>;
    }
}

/// Keys of a robot that exclude each other.
pub(super) const ROBOT_RULES: &[Rule] = &[Rule::OneOf(&["file", "urdf", "floating"])];

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
