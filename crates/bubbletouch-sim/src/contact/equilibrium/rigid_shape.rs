//! Shape of a free object or an obstacle: spheres or triangles.

use crate::geometry::Aabb;
use crate::objects::{MeshModel, Model, Sphere, SphereUnion};
use glam::DVec3;

/// Rigid shape in the frame of its object.
#[derive(Clone, Copy, Debug)]
pub enum RigidShape<'a> {
    /// Union of spheres.
    Spheres(&'a SphereUnion),
    /// Triangle mesh, with exact contact. The triangles of a closed mesh must face outwards.
    Mesh(&'a MeshModel),
}

impl<'a> RigidShape<'a> {
    /// Returns the spheres of the shape; none for a mesh.
    pub fn spheres(&self) -> &'a [Sphere] {
        match self {
            Self::Spheres(union) => union.spheres(),
            Self::Mesh(_) => &[],
        }
    }

    /// Returns the bounding box of the shape, metres.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Spheres(union) => union.bounds(),
            Self::Mesh(mesh) => mesh.bounds(),
        }
    }

    /// Returns the largest distance of a surface point from a point, metres.
    pub fn reach_from(&self, point: DVec3) -> f64 {
        match self {
            Self::Spheres(union) => union.reach_from(point),
            Self::Mesh(mesh) => {
                let corners = mesh.features().corners().iter();
                let distances = corners.map(|corner| corner.distance(point));
                distances.fold(0.0, f64::max) + mesh.rounding()
            }
        }
    }
}

impl<'a> From<&'a SphereUnion> for RigidShape<'a> {
    fn from(spheres: &'a SphereUnion) -> Self {
        Self::Spheres(spheres)
    }
}

impl<'a> From<&'a MeshModel> for RigidShape<'a> {
    fn from(mesh: &'a MeshModel) -> Self {
        Self::Mesh(mesh)
    }
}

impl<'a> From<&'a Model> for RigidShape<'a> {
    fn from(model: &'a Model) -> Self {
        match model {
            Model::Spheres(spheres) => Self::Spheres(spheres),
            Model::Mesh(mesh) => Self::Mesh(mesh),
        }
    }
}
