//! Specification of a scene: the keys of its TOML file, in the file's units.
//!
//! The specification checks only names and types. The scene plan checks the values.

pub use super::spec_motion::*;
pub use super::spec_patch::*;
use crate::error::Result;
use crate::files::FilePath;
use crate::inputs::check::Rule;
use crate::inputs::objects_spec::ModelSpec;
use crate::inputs::params::params;
use crate::inputs::range::Range::{NotNegative, Positive};
use crate::mesh::LengthUnit;
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

params! {
    /// Keys of a table `[[objects]]`: an object of the scene.
    pub struct ObjectSpec {
        /// Name of the object, unique in the scene.
        name: String;
        /// Name of a built-in object; the command `bubbletouch objects` lists them.
        object: Option<String>;
        /// TOML file of objects that contains the object named `object`. Default: the built-in objects.
        objects: Option<FilePath>;
        /// Parts of a solid in the frame of the object; replaces `object`. Each part is a table with the keys of `[[object.part]]` in a file of objects.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        parts: Vec<toml::Table> = Vec::new();
        /// Whether the origin of a solid is the middle of its bounding box. Default: false. The origin is then the middle of the base of a named object, or the
        /// origin of `parts`.
        #[serde(skip_serializing_if = "std::ops::Not::not")]
        centered: bool = false;
        /// CSV file of spheres with the columns x, y, z, r; replaces `object`.
        spheres: Option<FilePath>;
        /// Mesh file (PLY, OBJ, STL, Collada or glTF) of the object; replaces `object`.
        mesh: Option<FilePath>;
        /// Contact model of a mesh. Default: `mesh`, or `packed` in a scene with a free object.
        model: Option<ModelSpec>;
        /// Length unit of a mesh or of spheres. Default: metres. The size must then be between 0.1 mm and 10 m.
        unit: Option<LengthUnit>;
        /// Maximum distance between the spheres and the surface of a solid or packed mesh, mm. Default: 0.25, or a tenth of the finest pitch for a packed mesh.
        surface_error_mm: Option<f64> => Positive;
        /// Name of the robot that carries the object; `at` and `motion` are then in the frame of its link.
        robot: Option<String>;
        /// Name of the robot link that carries the object. Default: the base.
        link: Option<String>;
        /// Pose of the object in the world or on the link, or its initial pose if it moves. Default: the origin.
        at: PoseSpec = PoseSpec::default();
        /// Imposed motion of the object, which does not depend on contacts. Default: no motion.
        motion: Option<MotionSpec>;
        /// Force control in addition to `motion`: the object also moves along a line until the force on a patch reaches a target.
        press: Option<PressSpec>;
        /// Properties of a free object, whose pose follows from gravity and contacts; replaces `motion`.
        free: Option<FreeSpec>;
    }
}

params! {
    /// Keys of a free object, such as `free = { mass_kg = 0.2 }`.
    #[derive(Copy, Default)]
    pub struct FreeSpec {
        /// Mass of the object, kg, positive; required.
        mass_kg: Option<f64> => Positive;
        /// Centre of mass in the object frame, mm. Default: the centre of mass of a homogeneous solid.
        center_of_mass_mm: Option<[f64; 3]>;
    }
}

params! {
    /// Force control of an object, such as `press = { patch = "palm", direction = [0.0, 0.0, -1.0], force_n = 2.0, speed_mm_per_s = 20.0, travel_mm = 10.0 }`.
    ///
    /// The object starts at the pose of `at` and `motion` and moves along the direction until the force on the patch reaches the target. If the force is too large,
    /// the object moves back. Speed and travel are limited. The object does not pass through the patch: pressed taxels stay at their stroke, even if the target is
    /// not reached. If the target is zero, the object returns to the pose of its motion.
    pub struct PressSpec {
        /// Name of the patch whose force is controlled.
        patch: String;
        /// Direction of the object's travel in the world frame; its length is arbitrary.
        direction: [f64; 3];
        /// Target of the patch's total spring force from all objects, N, at least 0: one number, or one number for each time in `time_s`.
        force_n: Numbers => NotNegative;
        /// Times of the target forces since the start of the scene, s. Between the times, forces are interpolated linearly; outside, they are constant.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        time_s: Vec<f64> = Vec::new();
        /// Maximum speed of the object along the direction, mm/s, positive.
        speed_mm_per_s: f64 => Positive;
        /// Maximum distance of the object from the pose of its imposed motion, mm, positive.
        travel_mm: f64 => Positive;
    }
}

/// Keys that describe the shape of an object.
pub(super) const SHAPE_KEYS: [&str; 9] = [
    "object",
    "objects",
    "parts",
    "centered",
    "spheres",
    "mesh",
    "model",
    "unit",
    "surface_error_mm",
];

/// Keys of the shape of an object that exclude each other or act together.
pub(crate) const SHAPE_RULES: &[Rule] = &[
    Rule::OneOf(&["object", "parts", "spheres", "mesh"]),
    Rule::Beside("objects", &["object"]),
    Rule::Beside("centered", &["object", "parts"]),
    Rule::Beside("model", &["mesh"]),
    Rule::Beside("unit", &["mesh", "spheres"]),
];

/// Keys of the movement of an object that exclude each other or act together.
pub(super) const MOVEMENT_RULES: &[Rule] = &[
    Rule::Beside("link", &["robot"]),
    Rule::Excludes("free", &["robot", "motion", "press"]),
];

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
