//! Objects as they are written: `[[objects]]`.

use super::numbers::Numbers;
use crate::files::FilePath;
use crate::inputs::objects_spec::ModelSpec;
use crate::mesh::LengthUnit;
use crate::scene::spec_motion::{MotionSpec, PoseSpec};
use serde::{Deserialize, Serialize};

/// `[[objects]]`: what is touched.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectSpec {
    /// Its name in this scene.
    pub name: String,
    /// A built-in object (`bubbletouch objects` lists them).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<String>,
    /// A TOML file of objects, of which `object` is one; the built-in ones when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub objects: Option<FilePath>,
    /// Instead: a CSV file of spheres, columns x, y, z, r.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spheres: Option<FilePath>,
    /// Instead: a PLY, OBJ or STL file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<FilePath>,
    /// What a mesh becomes; spheres around its vertices when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelSpec>,
    /// Unit of the numbers of a mesh or of spheres. When left out, metres, and 0.1 mm to 10 m large.
    #[serde(default, alias = "mesh_unit", skip_serializing_if = "Option::is_none")]
    pub unit: Option<LengthUnit>,
    /// How far spheres may be from a solid's or packed mesh's surface; 0.25, or packed a tenth of the finest pitch, when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface_error_mm: Option<f64>,
    /// The robot that carries it, in place of a motion of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// The robot's link that carries it; its base when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link: Option<String>,
    /// Where it is, or starts, in the world or on the link.
    #[serde(default)]
    pub at: PoseSpec,
    /// How it moves, whatever touches it; not at all when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionSpec>,
    /// Beside `motion`: it is also pushed along a line so that a patch feels a force.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub press: Option<PressSpec>,
    /// Instead of `motion`: only gravity and skins hold it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free: Option<FreeSpec>,
}

/// `free = { mass_kg = 0.2 }`
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FreeSpec {
    /// What it weighs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass_kg: Option<f64>,
    /// In its own frame; that of a homogeneous solid when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub center_of_mass_mm: Option<[f64; 3]>,
}

/// `press = { patch = "palm", direction = [0.0, 0.0, -1.0], force_n = 2.0, speed_mm_per_s = 20.0, travel_mm = 10.0 }`
///
/// From where `at` and `motion` say that it is, the object goes along the direction until the patch feels the force; from step to step
/// no faster than the speed, never beyond the travel, and back if the force is too much. It does not pass through the patch: what it has
/// pressed stays at its stroke, however much more force is wanted. With a force of zero it goes back to
/// where its motion says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PressSpec {
    /// The patch that is to feel the force.
    pub patch: String,
    /// Where to, in the world; of any length.
    pub direction: [f64; 3],
    /// Σ k δ of the patch, whatever touches it: one force for all times, or one a time of `time_s`.
    pub force_n: Numbers,
    /// When the forces are wanted; straight lines between them, and the first and last beyond.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub time_s: Vec<f64>,
    /// Along the direction, at most.
    pub speed_mm_per_s: f64,
    /// From where the motion says, at most.
    pub travel_mm: f64,
}
