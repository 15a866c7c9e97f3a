//! What an object is made of for the contact kernel: spheres, or triangles.

use super::{MeshModel, SphereUnion};
use crate::geometry::Aabb;

/// The two shapes that taxels can touch, each in the object's frame.
#[derive(Clone, Debug)]
pub enum Model {
    /// A union of spheres.
    Spheres(SphereUnion),
    /// A triangle mesh, touched exactly.
    Mesh(MeshModel),
}

impl Model {
    /// The spheres, if it is made of them.
    pub fn spheres(&self) -> Option<&SphereUnion> {
        match self {
            Self::Spheres(spheres) => Some(spheres),
            Self::Mesh(_) => None,
        }
    }

    /// How many spheres; 0 for a mesh.
    pub fn n_spheres(&self) -> usize {
        self.spheres().map_or(0, SphereUnion::n_spheres)
    }

    /// How many triangles; 0 for spheres.
    pub fn n_triangles(&self) -> usize {
        match self {
            Self::Spheres(_) => 0,
            Self::Mesh(mesh) => mesh.mesh().n_triangles(),
        }
    }

    /// Sorts its spheres into [clusters](SphereUnion::clusters) now, which the first touch would do; the tree of a mesh is there.
    pub fn prepare(&self) {
        if let Self::Spheres(spheres) = self {
            spheres.clusters();
        }
    }

    /// The box around it, metres.
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
