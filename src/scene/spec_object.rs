//! Specification of objects: the tables `[[objects]]`.

use super::numbers::Numbers;
use crate::files::FilePath;
use crate::inputs::objects_spec::ModelSpec;
use crate::inputs::schema_types::Names;
use crate::mesh::LengthUnit;
use crate::scene::spec_motion::{MotionSpec, PoseSpec};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Keys of a table `[[objects]]`: an object of the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObjectSpec {
    /// Name of the object, unique in the scene.
    pub name: String,
    /// Name of a built-in object; the command `bubbletouch objects` lists them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<String>,
    /// TOML file of objects that contains the object named `object`. Default: the built-in objects.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<String>")]
    pub objects: Option<FilePath>,
    /// Parts of a solid in the frame of the object; replaces `object`. Each part is a table with the keys of `[[object.part]]` in a file of objects.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(with = "Vec<BTreeMap<String, serde_json::Value>>")]
    pub parts: Vec<toml::Table>,
    /// Whether the origin of a solid is the middle of its bounding box. Default: false. The origin is then the middle of the base of a named object, or the
    /// origin of `parts`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub centered: bool,
    /// CSV file of spheres with the columns x, y, z, r; replaces `object`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<String>")]
    pub spheres: Option<FilePath>,
    /// Mesh file (PLY, OBJ, STL, Collada or glTF) of the object; replaces `object`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<String>")]
    pub mesh: Option<FilePath>,
    /// Contact model of a mesh. Default: `mesh`, or `packed` in a scene with a free object.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelSpec>,
    /// Length unit of a mesh or of spheres. Default: metres. The size must then be between 0.1 mm and 10 m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Names<LengthUnit>>")]
    pub unit: Option<LengthUnit>,
    /// Maximum distance between the spheres and the surface of a solid or packed mesh, mm. Default: 0.25, or a tenth of the finest pitch for a packed mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface_error_mm: Option<f64>,
    /// Name of the robot that carries the object; `at` and `motion` are then in the frame of its link.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// Name of the robot link that carries the object. Default: the base.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link: Option<String>,
    /// Pose of the object in the world or on the link, or its initial pose if it moves. Default: the origin.
    #[serde(default)]
    pub at: PoseSpec,
    /// Imposed motion of the object, which does not depend on contacts. Default: no motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionSpec>,
    /// Force control in addition to `motion`: the object also moves along a line until the force on a patch reaches a target.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub press: Option<PressSpec>,
    /// Properties of a free object, whose pose follows from gravity and contacts; replaces `motion`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free: Option<FreeSpec>,
}

/// Keys of a free object, such as `free = { mass_kg = 0.2 }`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FreeSpec {
    /// Mass of the object, kg, positive; required.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass_kg: Option<f64>,
    /// Centre of mass in the object frame, mm. Default: the centre of mass of a homogeneous solid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub center_of_mass_mm: Option<[f64; 3]>,
}

/// Force control of an object, such as `press = { patch = "palm", direction = [0.0, 0.0, -1.0], force_n = 2.0, speed_mm_per_s = 20.0, travel_mm = 10.0 }`.
///
/// The object starts at the pose of `at` and `motion` and moves along the direction until the force on the patch reaches the target. If the force is too large,
/// the object moves back. Speed and travel are limited. The object does not pass through the patch: pressed taxels stay at their stroke, even if the target is
/// not reached. If the target is zero, the object returns to the pose of its motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressSpec {
    /// Name of the patch whose force is controlled.
    pub patch: String,
    /// Direction of the object's travel in the world frame; its length is arbitrary.
    pub direction: [f64; 3],
    /// Target of the patch's total spring force from all objects, N, at least 0: one number, or one number for each time in `time_s`.
    pub force_n: Numbers,
    /// Times of the target forces since the start of the scene, s. Between the times, forces are interpolated linearly; outside, they are constant.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub time_s: Vec<f64>,
    /// Maximum speed of the object along the direction, mm/s, positive.
    pub speed_mm_per_s: f64,
    /// Maximum distance of the object from the pose of its imposed motion, mm, positive.
    pub travel_mm: f64,
}
