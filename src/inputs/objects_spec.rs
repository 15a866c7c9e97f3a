//! The table `[objects]` of a study or scene file.

use crate::files::{FilePath, SetName};
use crate::inputs::units::MM;
use crate::mesh::{LengthUnit, SizeLimits};
use serde::{Deserialize, Serialize};

/// Default distance of spheres from a solid's surface, mm.
const SURFACE_ERROR_MM: f64 = 0.25;

/// The table `[objects]`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectsSpec {
    /// Sets of solids: built-in names (`household`, `balls`, `boxes`, `cans`, `hands`) or TOML files, their paths relative to the study file.
    #[serde(default)]
    pub sets: Vec<SetName>,
    /// Selection of objects from the sets and meshes. Default: all.
    pub names: Option<Vec<String>>,
    /// Folder of PLY, OBJ or STL meshes, one object per file; the path is relative to the study file.
    pub meshes: Option<FilePath>,
    /// Model built from each mesh. Default: the mesh itself.
    pub model: Option<ModelSpec>,
    /// Length unit of the mesh files. Default: metres; the size of each mesh must then be within `sizes`.
    #[serde(alias = "mesh_unit")]
    pub unit: Option<LengthUnit>,
    /// Allowed sizes of meshes without a unit; the plan derives them from the arrays.
    #[serde(skip)]
    pub sizes: Option<SizeLimits>,
    /// Distance between the taxels of the finest array, metres. Vertex spheres farther than half of this distance from their mesh are reported on standard
    /// error.
    #[serde(skip)]
    pub pitch: Option<f64>,
    /// Largest distance of the surface of a solid, or of a packed mesh, outside its spheres, mm. Spheres extend at most half of this distance beyond the
    /// surface, so the mean heights are equal. Default: 0.25; with `model = "packed"` a tenth of the finest pitch, which gives a mean deflection error of
    /// about 2 % of the pitch.
    pub surface_error_mm: Option<f64>,
    /// Largest width of holes that are closed before a mesh is packed or used, mm. Default: no holes are closed.
    pub close_holes_mm: Option<f64>,
}

/// Model built from a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelSpec {
    /// One sphere per vertex, as in the published protocol \[BT\].
    VertexSpheres,
    /// The triangles, with exact contact.
    #[default]
    Mesh,
    /// Few spheres within `surface_error_mm` of the mesh, which must be closed.
    Packed,
}

impl ModelSpec {
    /// Returns the default distance of spheres from the surface, mm: 0.25, or a tenth of the pitch (mm) for a packed mesh.
    pub fn default_surface_error_mm(self, pitch_mm: f64) -> f64 {
        match self {
            Self::Packed => 0.1 * pitch_mm,
            Self::VertexSpheres | Self::Mesh => SURFACE_ERROR_MM,
        }
    }
}

impl ObjectsSpec {
    /// Returns the allowed sizes of objects whose files have no unit.
    pub(crate) fn sizes(&self) -> SizeLimits {
        self.sizes.unwrap_or(SizeLimits::ANY)
    }

    /// Returns the largest width of holes that are closed, metres.
    pub(crate) fn close_holes(&self) -> Option<f64> {
        self.close_holes_mm.map(|width| width * MM)
    }

    /// Returns the largest distance of spheres from a surface, metres.
    pub(crate) fn surface_error(&self) -> f64 {
        self.surface_error_mm.unwrap_or(SURFACE_ERROR_MM) * MM
    }
}
