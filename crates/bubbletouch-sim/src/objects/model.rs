//! Contact model of an object: spheres or triangles.

use super::{MeshModel, SphereUnion};
use crate::geometry::Aabb;
use glam::DVec3;

/// Contact model: the shape of an object that taxels can touch, in the frame of the object.
#[derive(Clone, Debug)]
pub enum Model {
    /// Union of spheres.
    Spheres(SphereUnion),
    /// Triangle mesh, with exact contact.
    Mesh(MeshModel),
}

impl Model {
    /// Returns the spheres of the model; `None` for a mesh.
    pub fn spheres(&self) -> Option<&SphereUnion> {
        match self {
            Self::Spheres(spheres) => Some(spheres),
            Self::Mesh(_) => None,
        }
    }

    /// Returns the number of spheres of the model; 0 for a mesh.
    pub fn n_spheres(&self) -> usize {
        self.spheres().map_or(0, SphereUnion::n_spheres)
    }

    /// Returns the number of triangles of the model; 0 for spheres.
    pub fn n_triangles(&self) -> usize {
        match self {
            Self::Spheres(_) => 0,
            Self::Mesh(mesh) => mesh.mesh().n_triangles(),
        }
    }

    /// Computes the clusters of the spheres now instead of at the first touch; for a mesh, nothing remains to be computed.
    pub fn prepare(&self) {
        if let Self::Spheres(spheres) = self {
            spheres.clusters();
        }
    }

    /// Returns the centre of mass of the homogeneous solid, in the object's frame, metres.
    pub fn center_of_mass(&self) -> DVec3 {
        match self {
            Self::Spheres(spheres) => spheres.center_of_mass(),
            Self::Mesh(mesh) => mesh.mesh().center_of_mass(),
        }
    }

    /// Returns the bounding box of the model, metres.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Spheres(spheres) => spheres.bounds(),
            Self::Mesh(mesh) => mesh.bounds(),
        }
    }
}

impl From<SphereUnion> for Model {
    fn from(spheres: SphereUnion) -> Self {
        Self::Spheres(spheres)
    }
}

impl From<MeshModel> for Model {
    fn from(mesh: MeshModel) -> Self {
        Self::Mesh(mesh)
    }
}
