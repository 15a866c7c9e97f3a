//! Specification of skin patches: the tables `[[patches]]`.

use super::numbers::Numbers;
use crate::files::FilePath;
use crate::inputs::schema_types::Names;
use crate::inputs::sensor_errors::{NOISES, all_strengths, noise_words, strength_words};
use crate::mesh::LengthUnit;
use crate::scene::spec_motion::PoseSpec;
use crate::signal::MAX_STRENGTHS;
use crate::world::{MissingTaxels, ShapeRole};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Keys of a table `[[patches]]`: a patch of skin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PatchSpec {
    /// Name of the patch, unique in the scene.
    pub name: String,
    /// Name of the robot that carries the patch. Default: the patch is fixed in the world.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// Name of the robot link that carries the patch. Default: the base.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link: Option<String>,
    /// Name of the object that carries the patch, instead of a robot. A patch never touches the object that carries it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<String>,
    /// Pose of the patch on the link, on the object, or in the world. Default: the origin.
    #[serde(default)]
    pub at: PoseSpec,
    /// Layout of the taxels on the patch, for example a grid.
    pub layout: LayoutSpec,
    /// Radius of the spherical taxels, mm. Default: half the pitch. This key and the following ones are a number for all taxels, a list with one number per
    /// taxel, or a column of `taxels_csv`. Lists have the order of the layout (for a grid, row by row).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub taxel_radius_mm: Option<Numbers>,
    /// Stroke (maximum deflection) of the taxels, mm; required.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stroke_mm: Option<Numbers>,
    /// Stiffness of the taxels along their axes, N/m. Default: 100.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness_n_per_m: Option<Numbers>,
    /// Damping coefficient of the taxels along their axes, N·s/m. Default: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping_n_s_per_m: Option<Numbers>,
    /// Friction coefficient between taxels and objects. With friction, tangential springs hold the contacts until they slip. Default: no friction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<Numbers>,
    /// Tangential stiffness of the taxels, N/m, used with `friction`. Default: the stiffness along the axes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shear_stiffness_n_per_m: Option<Numbers>,
    /// CSV file with one row per taxel. Its columns have the names of the keys above; only columns that differ between taxels are needed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<String>")]
    pub taxels_csv: Option<FilePath>,
    /// Steps of the patch's signal chain (noise and sensor errors), in order. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub signal: Vec<SignalStepSpec>,
}

/// Step of the signal chain, as in `signal = ["force", { noise_std_n = 0.1 }, { dead_fraction = 0.01 }]`. The keys are the same as in `[signal]` of studies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum SignalStepSpec {
    /// The word `"force"`, allowed as the first step: the chain then starts with forces instead of deflections.
    Word(String),
    /// Names of noises or sensor errors with their strengths. Two keys of one step may be given together.
    Strengths(BTreeMap<String, f64>),
}

/// JSON schema built from the list of sensor errors, which also defines the accepted keys.
impl JsonSchema for SignalStepSpec {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "SignalStepSpec".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let mut keys = serde_json::Map::new();
        for (key, words) in scene_steps() {
            let number = json_schema!({ "type": "number", "minimum": 0, "description": words });
            keys.insert(key.to_owned(), number.into());
        }
        json_schema!({
            "title": "`\"force\"` or a table with a key of a step, such as `{ noise_std_n = 0.1 }`",
            "anyOf": [
                { "type": "string", "const": "force" },
                {
                    "type": "object",
                    "properties": keys,
                    "additionalProperties": false,
                    "minProperties": 1,
                    "maxProperties": MAX_STRENGTHS,
                },
            ]
        })
    }
}

/// Returns the keys and descriptions of the signal steps that a patch of a scene allows. Steps that need earlier and later frames are omitted.
fn scene_steps() -> impl Iterator<Item = (&'static str, String)> {
    let noises = NOISES.iter().map(|(key, unit)| (*key, noise_words(*unit)));
    let smoothing = "Standard deviation of the Gaussian smoothing over the array, mm.";
    let errors = all_strengths().filter(|(error, _)| error.about().is_of_single_frames());
    let errors = errors.map(|(error, strength)| (strength.key, strength_words(error, strength)));
    noises
        .chain([("smoothing_mm", smoothing.to_owned())])
        .chain(errors)
}

/// Layout of the taxels, such as `layout = { grid = { nx = 64, ny = 64, pitch_mm = 2.0 } }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LayoutSpec {
    /// Grid of nx × ny taxels in square cells.
    Grid {
        /// Number of columns, along the patch's x axis.
        nx: usize,
        /// Number of rows, along the patch's y axis.
        ny: usize,
        /// Distance between neighbouring taxels, mm.
        pitch_mm: f64,
    },
    /// Hexagonal lattice with staggered rows, in a rectangle.
    Hexagonal {
        /// Number of taxels per row, along the patch's x axis.
        nx: usize,
        /// Number of rows, along the patch's y axis.
        ny: usize,
        /// Distance between a taxel and its six neighbours, mm; rows are 0.866 times this distance apart.
        pitch_mm: f64,
    },
    /// Hexagonal lattice in a disc.
    Disc {
        /// Radius of the disc, mm.
        radius_mm: f64,
        /// Distance between a taxel and its six neighbours, mm.
        pitch_mm: f64,
    },
    /// Taxels in an annulus between two radii.
    Annulus {
        /// Inner radius of the annulus, mm.
        inner_mm: f64,
        /// Outer radius of the annulus, mm.
        outer_mm: f64,
        /// Distance between neighbouring taxels, mm.
        pitch_mm: f64,
    },
    /// Taxels on a cylindrical surface, as on a forearm or finger.
    Cylinder {
        /// Radius of the cylinder, mm.
        radius_mm: f64,
        /// Length along the cylinder's axis, mm.
        length_mm: f64,
        /// Angle around the cylinder's axis that the taxels cover, degrees.
        arc_deg: f64,
        /// Distance between neighbouring taxels, mm.
        pitch_mm: f64,
    },
    /// Taxels on a spherical cap, as on a fingertip.
    SphereCap {
        /// Radius of the sphere, mm.
        radius_mm: f64,
        /// Angle from the pole to the rim of the cap, degrees.
        half_angle_deg: f64,
        /// Distance between neighbouring taxels, mm.
        pitch_mm: f64,
    },
    /// Taxels listed in a file, such as `layout = { file = "palm.csv" }`: `.csv`, `.npz`, `.txt` or `.ini` (iCub), `.json` (PaXini) or `.urdf`.
    File(FileLayoutSpec),
    /// Taxels of a tactile sensor, which is given by its name in the robot's file.
    Sensor(String),
    /// Taxels on the outer surface of a triangle mesh, or of a link of the patch's robot.
    Draped {
        /// Mesh file of the surface; omitted if `on` or `region.link` is given.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "Option<String>")]
        mesh: Option<FilePath>,
        /// Length unit of the mesh file. Default: metres. The size must then be between 0.1 mm and 10 m.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "Option<Names<LengthUnit>>")]
        unit: Option<LengthUnit>,
        /// Shapes of the patch's own link that form the surface, instead of a mesh file: `collision` or `visual`. The shapes include meshes of the robot's file.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "Option<Names<ShapeRole>>")]
        on: Option<ShapeRole>,
        /// Distance between neighbouring taxels, mm.
        pitch_mm: f64,
        /// Part of the surface that carries taxels. Default: the whole outer surface.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        region: Option<Box<RegionSpec>>,
        /// Flat grid of taxels that is wrapped around the surface. Default: the taxels are distributed over the surface.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        grid: Option<Box<ProjectedGridSpec>>,
    },
}

/// Flat grid of taxels that is wrapped around a surface. Each taxel moves along −z of the grid to the surface and takes the surface normal there as its axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProjectedGridSpec {
    /// Number of columns, along the grid's x axis, `pitch_mm` apart.
    pub nx: usize,
    /// Number of rows, along the grid's y axis, `pitch_mm` apart.
    pub ny: usize,
    /// Pose of the grid's middle in the frame of the mesh or link. The pose is in front of the surface, and its z axis points away from the surface.
    pub at: PoseSpec,
    /// Treatment of taxels that do not meet the surface: `error` refuses the scene, `drop` omits them. Default: `error`.
    #[serde(default)]
    pub missing: MissingSpec,
}

/// Treatment of taxels of a projected grid that do not meet the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MissingSpec {
    /// The scene is refused.
    #[default]
    Error,
    /// The taxels are omitted.
    Drop,
}

impl From<MissingSpec> for MissingTaxels {
    fn from(spec: MissingSpec) -> Self {
        match spec {
            MissingSpec::Error => Self::Refuse,
            MissingSpec::Drop => Self::Drop,
        }
    }
}

/// Layout file, as `file = "palm.csv"` or `file = { path = "points.json", mesh = "fingertip.stl" }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum FileLayoutSpec {
    /// Path of the layout file, for formats that need no further information.
    Path(#[schemars(with = "String")] FilePath),
    /// Path of the layout file, and the further information that its format needs.
    Parts(FileLayoutParts),
}

/// Layout file, and the further information that its format needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FileLayoutParts {
    /// Path of the layout file.
    #[schemars(with = "String")]
    pub path: FilePath,
    /// Mesh whose surface normals are the taxel axes, for files of points without normals.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<String>")]
    pub mesh: Option<FilePath>,
    /// Length unit of the mesh file. Default: metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Names<LengthUnit>>")]
    pub unit: Option<LengthUnit>,
    /// Name of the tactile sensor, if a robot's file contains several sensors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
}

/// Part of a surface on which taxels are placed, such as `region = { group = "fingertip", box_min_mm = [0.0, 0.0, 0.0], box_max_mm = [20.0, 20.0, 10.0] }`. A
/// point belongs to the region if it satisfies all given keys.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionSpec {
    /// Smallest coordinates of a box in the mesh frame, mm, together with `box_max_mm`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub box_min_mm: Option<[f64; 3]>,
    /// Largest coordinates of the box in the mesh frame, mm, together with `box_min_mm`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub box_max_mm: Option<[f64; 3]>,
    /// Normal of a plane that bounds the region; its length is arbitrary, and it points to the side of the region.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane_normal: Option<[f64; 3]>,
    /// Point of the plane, mm, together with `plane_normal`. Default: the origin of the mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane_point_mm: Option<[f64; 3]>,
    /// Name of the link of the patch's `robot` whose shapes replace a mesh file; this link carries the patch. The box and the plane are then in the link frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link: Option<String>,
    /// Shapes of `link` that form the surface: `collision` or `visual`. Default: the collision shapes, or the visual ones if the link has no collision shapes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Names<ShapeRole>>")]
    pub shapes: Option<ShapeRole>,
    /// Name of a group (`g`) or object (`o`) of an OBJ file that forms the region.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
    /// Numbers of the first and last triangle of the region, counted from 0 in the order of the mesh file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub triangles: Option<[usize; 2]>,
}
