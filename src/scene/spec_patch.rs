//! Specification of skin patches: the tables `[[patches]]`.

use crate::engine::axis::Axis;
use crate::files::FilePath;
use crate::inputs::check::Rule;
use crate::inputs::params::{Described, named, params, variants, words};
use crate::inputs::range::MIN_POSITIVE;
use crate::inputs::range::Range::{self, AtLeastOne, Between, NotNegative, Positive};
use crate::inputs::sensor_errors::{SMOOTHING, SMOOTHING_WORDS, SignalKey, signal_keys};
use crate::mesh::LengthUnit;
use crate::scene::spec_motion::PoseSpec;
use crate::signal::{MAX_STRENGTHS, SensorError};
use crate::world::{MissingTaxels, ShapeRole};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

named!(ShapeRole);

/// Allowed angles around a cylinder.
const TURN: Range = Between(MIN_POSITIVE, 360.0, "above 0, at most 360");
/// Allowed angles from the pole of a sphere.
const HALF_TURN: Range = Between(MIN_POSITIVE, 180.0, "above 0, at most 180");

params! {
    /// Keys of a table `[[patches]]`: a patch of skin.
    pub struct PatchSpec {
        /// Name of the patch, unique in the scene.
        name: String;
        /// Name of the robot that carries the patch. Default: the patch is fixed in the world.
        robot: Option<String>;
        /// Name of the robot link that carries the patch. Default: the base.
        link: Option<String>;
        /// Name of the object that carries the patch, instead of a robot. A patch never touches the object that carries it.
        object: Option<String>;
        /// Pose of the patch on the link, on the object, or in the world. Default: the origin.
        at: PoseSpec = PoseSpec::default();
        /// Layout of the taxels on the patch, for example a grid.
        layout: LayoutSpec;
        /// Radius of the spherical taxels, mm. Default: half the pitch. This key and the following ones are a number for all taxels, a list with one number per
        /// taxel, or a column of `taxels_csv`. Lists have the order of the layout (for a grid, row by row).
        taxel_radius_mm: Option<Numbers> => Positive;
        /// Stroke (maximum deflection) of the taxels, mm; required.
        stroke_mm: Option<Numbers> => Positive;
        /// Stiffness of the taxels along their axes, N/m. Default: 100.
        stiffness_n_per_m: Option<Numbers> => Positive;
        /// Damping coefficient of the taxels along their axes, N·s/m. Default: 0.
        damping_n_s_per_m: Option<Numbers> => NotNegative;
        /// Friction coefficient between taxels and objects. With friction, tangential springs hold the contacts until they slip. Default: no friction.
        friction: Option<Numbers> => NotNegative;
        /// Tangential stiffness of the taxels, N/m, used with `friction`. Default: the stiffness along the axes.
        shear_stiffness_n_per_m: Option<Numbers> => Positive;
        /// CSV file with one row per taxel. Its columns have the names of the keys above; only columns that differ between taxels are needed.
        taxels_csv: Option<FilePath>;
        /// Steps of the patch's signal chain (noise and sensor errors), in order. Default: none.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        signal: Vec<SignalStepSpec> = Vec::new();
    }
}

/// Keys of a patch that exclude each other or act together.
pub(super) const PATCH_RULES: &[Rule] = &[
    Rule::Excludes("object", &["robot", "link"]),
    Rule::Beside("link", &["robot"]),
];

/// Keys of a draped layout that exclude each other or act together.
pub(super) const DRAPED_RULES: &[Rule] = &[
    Rule::Excludes("on", &["mesh"]),
    Rule::Beside("unit", &["mesh"]),
];

/// Keys of the part of a surface that exclude each other or act together.
pub(super) const REGION_RULES: &[Rule] = &[
    Rule::Beside("shapes", &["link"]),
    Rule::Excludes("link", &["group", "triangles"]),
    Rule::Excludes("group", &["triangles"]),
    Rule::Beside("box_min_mm", &["box_max_mm"]),
    Rule::Beside("box_max_mm", &["box_min_mm"]),
    Rule::Beside("plane_point_mm", &["plane_normal"]),
];

variants! {
    /// One number for all taxels or times, or a list: `stiffness_n_per_m = 100.0` or `stiffness_n_per_m = [90.0, 110.0]`.
    pub untagged enum Numbers {
        /// One number that applies to all elements.
        One(f64),
        /// List with one number for each element.
        Each(Vec<f64>),
    }
}

// The error of serde's untagged enum would only state that no variant matched.
impl<'de> Deserialize<'de> for Numbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(match Axis::deserialize(deserializer)? {
            Axis::One(number) => Self::One(number),
            Axis::Many(numbers) => Self::Each(numbers),
        })
    }
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

impl Described for SignalStepSpec {
    fn schema() -> Value {
        let keys = step_keys().map(|(name, words)| {
            let number = json!({ "type": "number", "minimum": 0, "description": words });
            (name.to_owned(), number)
        });
        json!({
            "title": "`\"force\"` or a table with a key of a step, such as `{ noise_std_n = 0.1 }`",
            "anyOf": [
                { "type": "string", "const": "force" },
                {
                    "type": "object",
                    "properties": Map::from_iter(keys),
                    "additionalProperties": false,
                    "minProperties": 1,
                    "maxProperties": MAX_STRENGTHS,
                },
            ]
        })
    }
}

/// Returns the keys and meanings of the steps that a patch of a scene allows. Steps that need earlier and later frames are omitted.
fn step_keys() -> impl Iterator<Item = (&'static str, &'static str)> {
    let is_of_single_frames = |key: &&SignalKey| {
        let error = key.error.map(SensorError::about);
        error.is_none_or(|about| about.is_of_single_frames())
    };
    let keys = signal_keys().iter().filter(is_of_single_frames);
    keys.map(|key| match key.about.name() {
        SMOOTHING => (SMOOTHING, SMOOTHING_WORDS),
        name => (name, &key.words[..]),
    })
}

variants! {
    /// Layout of the taxels, such as `layout = { grid = { nx = 64, ny = 64, pitch_mm = 2.0 } }`.
    pub enum LayoutSpec {
        /// Grid of nx × ny taxels in square cells.
        Grid = "grid"(GridSpec),
        /// Hexagonal lattice with staggered rows, in a rectangle.
        Hexagonal = "hexagonal"(HexagonalSpec),
        /// Hexagonal lattice in a disc.
        Disc = "disc"(DiscSpec),
        /// Taxels in an annulus between two radii.
        Annulus = "annulus"(AnnulusSpec),
        /// Taxels on a cylindrical surface, as on a forearm or finger.
        Cylinder = "cylinder"(CylinderSpec),
        /// Taxels on a spherical cap, as on a fingertip.
        SphereCap = "sphere_cap"(SphereCapSpec),
        /// Taxels listed in a file, such as `layout = { file = "palm.csv" }`: `.csv`, `.npz`, `.txt` or `.ini` (iCub), `.json` (PaXini) or `.urdf`.
        File = "file"(FileLayoutSpec),
        /// Taxels of a tactile sensor, which is given by its name in the robot's file.
        Sensor = "sensor"(String),
        /// Taxels on the outer surface of a triangle mesh, or of a link of the patch's robot.
        Draped = "draped"(DrapedSpec),
    }
}

params! {
    /// Grid of nx × ny taxels in square cells.
    #[derive(Copy)]
    pub struct GridSpec {
        /// Number of columns, along the patch's x axis.
        nx: usize => AtLeastOne;
        /// Number of rows, along the patch's y axis.
        ny: usize => AtLeastOne;
        /// Distance between neighbouring taxels, mm.
        pitch_mm: f64 => Positive;
    }
}

params! {
    /// Hexagonal lattice with staggered rows, in a rectangle.
    #[derive(Copy)]
    pub struct HexagonalSpec {
        /// Number of taxels per row, along the patch's x axis.
        nx: usize => AtLeastOne;
        /// Number of rows, along the patch's y axis.
        ny: usize => AtLeastOne;
        /// Distance between a taxel and its six neighbours, mm; rows are 0.866 times this distance apart.
        pitch_mm: f64 => Positive;
    }
}

params! {
    /// Hexagonal lattice in a disc.
    #[derive(Copy)]
    pub struct DiscSpec {
        /// Radius of the disc, mm.
        radius_mm: f64 => Positive;
        /// Distance between a taxel and its six neighbours, mm.
        pitch_mm: f64 => Positive;
    }
}

params! {
    /// Taxels in an annulus between two radii.
    #[derive(Copy)]
    pub struct AnnulusSpec {
        /// Inner radius of the annulus, mm.
        inner_mm: f64 => Positive;
        /// Outer radius of the annulus, mm.
        outer_mm: f64 => Positive;
        /// Distance between neighbouring taxels, mm.
        pitch_mm: f64 => Positive;
    }
}

params! {
    /// Taxels on a cylindrical surface, as on a forearm or finger.
    #[derive(Copy)]
    pub struct CylinderSpec {
        /// Radius of the cylinder, mm.
        radius_mm: f64 => Positive;
        /// Length along the cylinder's axis, mm.
        length_mm: f64 => NotNegative;
        /// Angle around the cylinder's axis that the taxels cover, degrees.
        arc_deg: f64 => TURN;
        /// Distance between neighbouring taxels, mm.
        pitch_mm: f64 => Positive;
    }
}

params! {
    /// Taxels on a spherical cap, as on a fingertip.
    #[derive(Copy)]
    pub struct SphereCapSpec {
        /// Radius of the sphere, mm.
        radius_mm: f64 => Positive;
        /// Angle from the pole to the rim of the cap, degrees.
        half_angle_deg: f64 => HALF_TURN;
        /// Distance between neighbouring taxels, mm.
        pitch_mm: f64 => Positive;
    }
}

params! {
    /// Taxels on the outer surface of a triangle mesh, or of a link of the patch's robot.
    pub struct DrapedSpec {
        /// Mesh file of the surface; omitted if `on` or `region.link` is given.
        mesh: Option<FilePath>;
        /// Length unit of the mesh file. Default: metres. The size must then be between 0.1 mm and 10 m.
        unit: Option<LengthUnit>;
        /// Shapes of the patch's own link that form the surface, instead of a mesh file: `collision` or `visual`. The shapes include meshes of the robot's file.
        on: Option<ShapeRole>;
        /// Distance between neighbouring taxels, mm.
        pitch_mm: f64 => Positive;
        /// Part of the surface that carries taxels. Default: the whole outer surface.
        region: Option<Box<RegionSpec>>;
        /// Flat grid of taxels that is wrapped around the surface. Default: the taxels are distributed over the surface.
        grid: Option<Box<ProjectedGridSpec>>;
    }
}

params! {
    /// Flat grid of taxels that is wrapped around a surface. Each taxel moves along −z of the grid to the surface and takes the surface normal there as its axis.
    pub struct ProjectedGridSpec {
        /// Number of columns, along the grid's x axis, `pitch_mm` apart.
        nx: usize => AtLeastOne;
        /// Number of rows, along the grid's y axis, `pitch_mm` apart.
        ny: usize => AtLeastOne;
        /// Pose of the grid's middle in the frame of the mesh or link. The pose is in front of the surface, and its z axis points away from the surface.
        at: PoseSpec;
        /// Treatment of taxels that do not meet the surface: `error` refuses the scene, `drop` omits them. Default: `error`.
        missing: MissingSpec = MissingSpec::default();
    }
}

words! {
    /// Treatment of taxels of a projected grid that do not meet the surface.
    pub enum MissingSpec = Error {
        /// The scene is refused.
        Error = "error",
        /// The taxels are omitted.
        Drop = "drop",
    }
}

impl From<MissingSpec> for MissingTaxels {
    fn from(spec: MissingSpec) -> Self {
        match spec {
            MissingSpec::Error => Self::Refuse,
            MissingSpec::Drop => Self::Drop,
        }
    }
}

variants! {
    /// Layout file, as `file = "palm.csv"` or `file = { path = "points.json", mesh = "fingertip.stl" }`.
    pub untagged enum FileLayoutSpec, Deserialize {
        /// Path of the layout file, for formats that need no further information.
        Path(FilePath),
        /// Path of the layout file, and the further information that its format needs.
        Parts(FileLayoutParts),
    }
}

params! {
    /// Layout file, and the further information that its format needs.
    pub struct FileLayoutParts {
        /// Path of the layout file.
        path: FilePath;
        /// Mesh whose surface normals are the taxel axes, for files of points without normals.
        mesh: Option<FilePath>;
        /// Length unit of the mesh file. Default: metres.
        unit: Option<LengthUnit>;
        /// Name of the tactile sensor, if a robot's file contains several sensors.
        sensor: Option<String>;
    }
}

params! {
    /// Part of a surface on which taxels are placed, such as `region = { group = "fingertip", box_min_mm = [0.0, 0.0, 0.0], box_max_mm = [20.0, 20.0, 10.0] }`. A
    /// point belongs to the region if it satisfies all given keys.
    #[derive(Default)]
    pub struct RegionSpec {
        /// Smallest coordinates of a box in the mesh frame, mm, together with `box_max_mm`.
        box_min_mm: Option<[f64; 3]>;
        /// Largest coordinates of the box in the mesh frame, mm, together with `box_min_mm`.
        box_max_mm: Option<[f64; 3]>;
        /// Normal of a plane that bounds the region; its length is arbitrary, and it points to the side of the region.
        plane_normal: Option<[f64; 3]>;
        /// Point of the plane, mm, together with `plane_normal`. Default: the origin of the mesh.
        plane_point_mm: Option<[f64; 3]>;
        /// Name of the link of the patch's `robot` whose shapes replace a mesh file; this link carries the patch. The box and the plane are then in the link frame.
        link: Option<String>;
        /// Shapes of `link` that form the surface: `collision` or `visual`. Default: the collision shapes, or the visual ones if the link has no collision shapes.
        shapes: Option<ShapeRole>;
        /// Name of a group (`g`) or object (`o`) of an OBJ file that forms the region.
        group: Option<String>;
        /// Numbers of the first and last triangle of the region, counted from 0 in the order of the mesh file.
        triangles: Option<[usize; 2]>;
    }
}
