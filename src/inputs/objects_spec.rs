//! Specification of objects: the table `[objects]` of a study or scene file.

use crate::acts;
use crate::files::{FilePath, SetName};
use crate::inputs::keys::Acts;
use crate::inputs::params::{named, params, words};
use crate::inputs::range::Range::{Any, Positive, Unchecked};
use crate::inputs::range::SURFACE_ERROR;
use crate::inputs::units::MM;
use crate::mesh::{LengthUnit, SizeLimits};

named!(LengthUnit);

/// Default maximum distance between the surface of a solid and the spheres that represent it, mm.
const SURFACE_ERROR_MM: f64 = 0.25;

/// Condition of the keys that meshes alone have.
const OF_MESHES: &[Acts] = acts![ObjectsSpec: |objects| objects.meshes.is_some()
    => "", "it only beside meshes = \"FOLDER\": solids are spheres within surface_error_mm"];

params! {
    /// Keys of the table `[objects]`: the objects of a study or scene.
    #[derive(Default)]
    pub struct ObjectsSpec {
        /// Sets of solids: built-in names (`household`, `balls`, `boxes`, `cans`, `hands`) or paths of TOML files relative to the study file.
        sets: Vec<SetName> = Vec::new() => Unchecked, Condition, Axes;
        /// Names of the objects that are selected from the sets and meshes. Default: all objects.
        names: Option<Vec<String>> => Any, Condition, Axes;
        /// Folder of PLY, OBJ, STL, Collada or glTF meshes with one object per file, relative to the study file.
        meshes: Option<FilePath> => Unchecked, Condition, Axes;
        /// Model that is built from each mesh: `mesh` (default), `packed` or `vertex_spheres`.
        model: Option<ModelSpec> => Any, Condition, Axes, acts: OF_MESHES;
        /// Length unit of the mesh files. Default: metres. The size of each mesh must then be within plausible limits.
        unit: Option<LengthUnit> => Any, Condition, Axes, acts: OF_MESHES;
        /// Maximum distance between the surface of a solid or packed mesh and its spheres, mm, at least 1e-6. Spheres extend at most half of this distance beyond
        /// the surface, so the mean heights are equal. Default: 0.25, or a tenth of the finest pitch with `model = "packed"`, which gives a mean deflection error
        /// of about 2 % of the pitch.
        surface_error_mm: Option<f64> => SURFACE_ERROR, Condition, Axes;
        /// Maximum width of holes that are closed before a mesh is packed or used, mm. Default: no holes are closed.
        close_holes_mm: Option<f64> => Positive, Condition, Axes, acts: OF_MESHES;
    }
    unread {
        /// Range of allowed sizes of meshes without a given unit. This is not a key of the file: the plan derives the limits from the arrays.
        sizes: Option<SizeLimits>;
        /// Pitch of the finest array, metres. This is not a key of the file. If vertex spheres are farther than half a pitch from their mesh, a note is printed on
        /// standard error.
        pitch: Option<f64>;
    }
}

words! {
    /// Contact model that is built from a mesh.
    pub enum ModelSpec = Mesh {
        /// One sphere around each vertex, as in the published protocol \[BT\].
        VertexSpheres = "vertex_spheres",
        /// Triangle mesh, for which contacts are computed exactly.
        Mesh = "mesh",
        /// Few spheres whose distance from the mesh is at most `surface_error_mm`; the mesh must be closed.
        Packed = "packed",
    }
}

impl ModelSpec {
    /// Returns the default maximum distance between spheres and surface, mm: 0.25, or a tenth of the pitch (mm) for a packed mesh.
    pub fn default_surface_error_mm(self, pitch_mm: f64) -> f64 {
        match self {
            Self::Packed => 0.1 * pitch_mm,
            Self::VertexSpheres | Self::Mesh => SURFACE_ERROR_MM,
        }
    }
}

impl ObjectsSpec {
    /// Returns the allowed sizes of objects whose files state no unit.
    pub(crate) fn sizes(&self) -> SizeLimits {
        self.sizes.unwrap_or(SizeLimits::ANY)
    }

    /// Returns the maximum width of holes that are closed before a mesh is used, metres.
    pub(crate) fn close_holes(&self) -> Option<f64> {
        self.close_holes_mm.map(|width| width * MM)
    }

    /// Returns the maximum distance between the spheres and the surface of an object, metres.
    pub(crate) fn surface_error(&self) -> f64 {
        self.surface_error_mm.unwrap_or(SURFACE_ERROR_MM) * MM
    }
}
