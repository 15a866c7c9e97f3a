//! `[objects]`: what a study or a scene touches, as it is written.

use crate::files::{FilePath, SetName};
use crate::inputs::units::MM;
use crate::mesh::{LengthUnit, SizeLimits};
use serde::{Deserialize, Serialize};

/// How far spheres may be from a solid's surface, unless a study says: mm.
const SURFACE_ERROR_MM: f64 = 0.25;

/// `[objects]`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectsSpec {
    /// Sets of solids: built-in names (`household`, `balls`, `boxes`, `cans`, `hands`) or TOML files, their paths relative to the study file.
    #[serde(default)]
    pub sets: Vec<SetName>,
    /// Only these objects of the sets and meshes; all when left out.
    pub names: Option<Vec<String>>,
    /// A folder of PLY, OBJ or STL meshes, one object a file; its path is relative to the study file.
    pub meshes: Option<FilePath>,
    /// What the meshes become; themselves when left out.
    pub model: Option<ModelSpec>,
    /// The unit of the meshes' files. When left out, metres, and each must be of a size that the arrays can feel.
    #[serde(alias = "mesh_unit")]
    pub unit: Option<LengthUnit>,
    /// That size: a plan knows the arrays.
    #[serde(skip)]
    pub sizes: Option<SizeLimits>,
    /// Distance between the taxels of the finest array, metres. Vertex spheres that are farther than half of it from their mesh are
    /// reported on standard error.
    #[serde(skip)]
    pub pitch: Option<f64>,
    /// How far the surface of a solid, or of a packed mesh, may be outside its spheres, mm; they reach at most half of it outside
    /// the solid, so that the two are equally high on average. When left out, 0.25; with
    /// `model = "packed"` a tenth of the finest pitch, which leaves a mean deflection error of about 2 % of the pitch.
    pub surface_error_mm: Option<f64>,
    /// Holes of the meshes at most this wide are closed before they are packed, or touched as they are, mm; none when left out.
    pub close_holes_mm: Option<f64>,
}

/// What a mesh becomes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelSpec {
    /// One sphere a vertex, as the published protocol \[BT\].
    VertexSpheres,
    /// The triangles themselves, touched exactly.
    #[default]
    Mesh,
    /// Few spheres within `surface_error_mm` of the mesh, which must be closed.
    Packed,
}

impl ModelSpec {
    /// How far spheres may be from the surface when nobody says, mm: 0.25, or of a packed mesh a tenth of the pitch (mm).
    pub fn default_surface_error_mm(self, pitch_mm: f64) -> f64 {
        match self {
            Self::Packed => 0.1 * pitch_mm,
            Self::VertexSpheres | Self::Mesh => SURFACE_ERROR_MM,
        }
    }
}

impl ObjectsSpec {
    /// How large objects may be whose files have no unit.
    pub(crate) fn sizes(&self) -> SizeLimits {
        self.sizes.unwrap_or(SizeLimits::ANY)
    }

    /// The widest holes that are closed, metres.
    pub(crate) fn close_holes(&self) -> Option<f64> {
        self.close_holes_mm.map(|width| width * MM)
    }

    /// How far spheres may be from a surface, metres.
    pub(crate) fn surface_error(&self) -> f64 {
        self.surface_error_mm.unwrap_or(SURFACE_ERROR_MM) * MM
    }
}
