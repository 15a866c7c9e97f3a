//! What touches what, as it is written: `[objects]`, `[skin]` and `[touches]`.

use super::axis::Axis;
use super::spec::one_value;
use crate::mesh::{LengthUnit, SizeLimits};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// `[objects]`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectsSpec {
    /// Sets of solids: built-in names (`household`, `balls`, `boxes`, `cans`) or TOML files.
    #[serde(default)]
    pub sets: Vec<String>,
    /// Only these objects of the sets and meshes; all when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub names: Option<Vec<String>>,
    /// A folder of PLY, OBJ or STL meshes, one object a file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub meshes: Option<PathBuf>,
    /// What the meshes become; spheres around their vertices when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelSpec>,
    /// The unit of the meshes' files. When left out, metres, and each must be of a size that the arrays can feel.
    #[serde(default, alias = "mesh_unit", skip_serializing_if = "Option::is_none")]
    pub unit: Option<LengthUnit>,
    /// That size: a plan knows the arrays.
    #[serde(skip)]
    pub sizes: Option<SizeLimits>,
    /// How far the surface of a solid, or of a packed mesh, may be outside its spheres, mm; they reach at most half of it outside
    /// the solid, so that the two are equally high on average. When left out, 0.25; with
    /// `model = "packed"` a tenth of the finest pitch, which leaves a mean deflection error of about 2 % of the pitch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface_error_mm: Option<f64>,
}

/// `[skin]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SkinSpec {
    /// Axis: distance between taxels, mm.
    pub pitch_mm: Axis<f64>,
    /// Axis: side length of the square array, mm; a whole number of pitches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size_mm: Option<Axis<f64>>,
    /// Axis, instead of `size_mm`: taxels along a side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub taxels: Option<Axis<usize>>,
    /// ρ, mm; half the pitch when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub taxel_radius_mm: Option<f64>,
    /// s, mm.
    pub stroke_mm: f64,
    /// k, N/m.
    #[serde(default = "default_stiffness")]
    pub stiffness_n_per_m: f64,
    /// c, N·s/m.
    #[serde(default)]
    pub damping_n_s_per_m: f64,
}

/// `[touches]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TouchesSpec {
    /// How the object lies on the table.
    #[serde(default)]
    pub rest: RestSpec,
    /// Touches an object; all combinations when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub per_object: Option<usize>,
    /// Where the patch's centre is over the object's, along table x, mm.
    #[serde(default = "zero")]
    pub offset_x_mm: SpreadSpec,
    /// The same along table y, mm.
    #[serde(default = "zero")]
    pub offset_y_mm: SpreadSpec,
    /// How the object is turned about the vertical, degrees.
    #[serde(default = "zero")]
    pub yaw_deg: SpreadSpec,
    /// How the patch is tilted about its x axis, degrees.
    #[serde(default = "zero")]
    pub tilt_x_deg: SpreadSpec,
    /// The same about its y axis, degrees.
    #[serde(default = "zero")]
    pub tilt_y_deg: SpreadSpec,
    /// How far the patch goes past first contact, mm.
    pub depth_mm: SpreadSpec,
    /// Axis: F, frames a touch: it is read at the depths d/F, 2d/F … d, each frame with noise of its own, and the measurements
    /// of all of them are its features.
    #[serde(default = "one_value")]
    pub frames: Axis<usize>,
    /// Approach speed at the moment of reading, mm/s: what the damper feels.
    #[serde(default)]
    pub speed_mm_per_s: f64,
}

/// No touches: those of a study that does not press objects.
impl Default for TouchesSpec {
    fn default() -> Self {
        Self {
            rest: RestSpec::default(),
            per_object: None,
            offset_x_mm: zero(),
            offset_y_mm: zero(),
            yaw_deg: zero(),
            tilt_x_deg: zero(),
            tilt_y_deg: zero(),
            depth_mm: SpreadSpec::List(Vec::new()),
            frames: one_value(),
            speed_mm_per_s: 0.0,
        }
    }
}

/// What a mesh becomes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelSpec {
    /// One sphere a vertex, as the original \[BT\].
    #[default]
    VertexSpheres,
    /// The triangles themselves, touched exactly.
    Mesh,
    /// Few spheres within `surface_error_mm` of the mesh, which must be closed.
    Packed,
}

/// How an object lies on the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RestSpec {
    /// With its own z axis up.
    #[default]
    AsModelled,
    /// In one of its stable poses, the likelier ones more often.
    Stable,
}

/// How a touch parameter is spread over touches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a number, a list, { grid = [first, last, count] } or { uniform = [low, high] }"
)]
pub enum SpreadSpec {
    /// `yaw_deg = 30.0`
    One(f64),
    /// `yaw_deg = [0.0, 10.0, 20.0]`
    List(Vec<f64>),
    /// `yaw_deg = { grid = [0.0, 50.0, 6] }` or `{ uniform = [0.0, 360.0] }`
    Range(RangeSpec),
}

/// A grid or an interval.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum RangeSpec {
    /// First value, last value, how many.
    Grid(f64, f64, usize),
    /// Drawn uniformly between two values.
    Uniform(f64, f64),
}

fn zero() -> SpreadSpec {
    SpreadSpec::One(0.0)
}

fn default_stiffness() -> f64 {
    100.0
}
