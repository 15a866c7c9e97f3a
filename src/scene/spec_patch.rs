//! Skin as it is written: `[[patches]]`.

use super::numbers::Numbers;
use crate::files::FilePath;
use crate::mesh::LengthUnit;
use crate::scene::spec_motion::PoseSpec;
use crate::world::ShapeRole;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// `[[patches]]`: skin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PatchSpec {
    /// Its name in this scene.
    pub name: String,
    /// The robot that carries it; the world when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// The robot's link that carries it; its base when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link: Option<String>,
    /// Instead: the object that carries it, which it does not feel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<String>,
    /// Where it is on the link, on the object, or in the world.
    #[serde(default)]
    pub at: PoseSpec,
    /// Where its taxels are.
    pub layout: LayoutSpec,
    /// ρ; half the pitch when left out. This and what follows: one for all taxels, a list of one each in the order of the layout (a
    /// grid's: row by row), or a column of `taxels_csv`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub taxel_radius_mm: Option<Numbers>,
    /// s; needed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stroke_mm: Option<Numbers>,
    /// k; 100 when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness_n_per_m: Option<Numbers>,
    /// c; none when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping_n_s_per_m: Option<Numbers>,
    /// μ: with it the tips of the taxels are dragged along and slip; without it they slide along their axes alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<Numbers>,
    /// k_t, beside `friction`; that of the spring along the axis when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shear_stiffness_n_per_m: Option<Numbers>,
    /// A file with a row a taxel: columns under the names of the keys above, those that differ.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub taxels_csv: Option<FilePath>,
    /// What its electronics make of what it feels, step by step.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub signal: Vec<SignalStepSpec>,
}

/// A step of `signal = ["force", { noise_std_n = 0.1 }, { dead_fraction = 0.01 }]`: the keys of a study's `[signal]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum SignalStepSpec {
    /// `"force"`, as the first: the signal begins with forces and not with deflections.
    Word(String),
    /// How strong a step is; two keys of one step may stand together.
    Strengths(BTreeMap<String, f64>),
}

/// `layout = { grid = { nx = 64, ny = 64, pitch_mm = 2.0 } }`: see [`Layout`](crate::world::Layout).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LayoutSpec {
    /// A rectangle of square cells.
    Grid {
        /// Columns, along patch x.
        nx: usize,
        /// Rows, along patch y.
        ny: usize,
        /// Between neighbours.
        pitch_mm: f64,
    },
    /// A rectangle of staggered rows.
    Hexagonal {
        /// Taxels a row, along patch x.
        nx: usize,
        /// Rows, along patch y.
        ny: usize,
        /// Between all six neighbours; rows are 0.866 times as far apart.
        pitch_mm: f64,
    },
    /// Round, a hexagonal lattice.
    Disc {
        /// Of the disc.
        radius_mm: f64,
        /// Between all six neighbours.
        pitch_mm: f64,
    },
    /// A ring.
    Annulus {
        /// Inner radius.
        inner_mm: f64,
        /// Outer radius.
        outer_mm: f64,
        /// Between neighbours.
        pitch_mm: f64,
    },
    /// Around a forearm or finger.
    Cylinder {
        /// Of the cylinder.
        radius_mm: f64,
        /// Along its axis.
        length_mm: f64,
        /// How far around.
        arc_deg: f64,
        /// Between neighbours.
        pitch_mm: f64,
    },
    /// On a fingertip.
    SphereCap {
        /// Of the sphere.
        radius_mm: f64,
        /// From the pole to the rim.
        half_angle_deg: f64,
        /// Between neighbours.
        pitch_mm: f64,
    },
    /// Over the outer surface of a triangle mesh, or of a link of the patch's robot.
    Draped {
        /// The file of the mesh; left out where `region.link` names a link.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        mesh: Option<FilePath>,
        /// Unit of the file's numbers. When left out, metres, and 0.1 mm to 10 m large.
        #[serde(default, alias = "mesh_unit", skip_serializing_if = "Option::is_none")]
        unit: Option<LengthUnit>,
        /// Between neighbours.
        pitch_mm: f64,
        /// The part that carries taxels; the whole outer surface when left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        region: Option<Box<RegionSpec>>,
    },
}

/// `region = { group = "fingertip", box_min_mm = [0.0, 0.0, 0.0], box_max_mm = [20.0, 20.0, 10.0] }`: the places for which all that is
/// given holds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegionSpec {
    /// In a box of the mesh's frame: its least corner, beside `box_max_mm`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub box_min_mm: Option<[f64; 3]>,
    /// Its greatest corner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub box_max_mm: Option<[f64; 3]>,
    /// On one side of a plane: the direction to that side, of any length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane_normal: Option<[f64; 3]>,
    /// A point of the plane, beside `plane_normal`; the mesh's origin when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane_point_mm: Option<[f64; 3]>,
    /// On the shapes of this link of the patch's `robot`, in place of a mesh file; the link carries the patch. The box and the plane are then in
    /// the link's frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link: Option<String>,
    /// Beside `link`: `collision` or `visual` shapes; when left out, the collision shapes if the link has any, else the visual ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shapes: Option<ShapeRole>,
    /// On the faces of an OBJ file's group (`g`) or object (`o`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
    /// On triangles with these numbers, first and last, from 0 in the order of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub triangles: Option<[usize; 2]>,
}
