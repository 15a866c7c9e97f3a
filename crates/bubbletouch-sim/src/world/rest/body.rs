//! What a table and gravity need to know of an object, whatever it is made of.

use super::mass;
use crate::geometry::{Aabb, Pose};
use crate::objects::{Model, Sphere};
use glam::{DQuat, DVec3};

/// Below this share of area^(3/2) a mesh holds no volume worth the name: a ball holds 0.094, a sheet of 100 × 100 × 0.1 mm 0.0004.
const HOLLOW: f64 = 1e-4;

impl Model {
    /// The box around it after a turn about its origin, metres.
    pub(crate) fn turned_bounds(&self, rotation: DQuat) -> Aabb {
        match self {
            Self::Spheres(union) => union.moved(&Pose::from_rotation(rotation)).bounds(),
            Self::Mesh(mesh) => mesh.turned_bounds(rotation),
        }
    }

    /// Spheres, or points as spheres of no radius, whose convex hull is its own.
    pub(crate) fn extremes(&self) -> Vec<Sphere> {
        let point = |center| Sphere {
            center,
            radius: 0.0,
        };
        match self {
            Self::Spheres(union) => union.spheres().to_vec(),
            Self::Mesh(mesh) => mesh.corners().map(point).collect(),
        }
    }

    /// As a homogeneous solid, in its own frame, metres. The volume decides where a mesh has its mass; a mesh without one, such as a sheet, is
    /// as heavy as its surface.
    pub fn center_of_mass(&self) -> DVec3 {
        let mesh = match self {
            Self::Spheres(union) => return mass::center_of_mass(union),
            Self::Mesh(mesh) => mesh.mesh(),
        };
        let (volume, center) = mesh.volume_and_centroid();
        match volume.abs() > HOLLOW * mesh.area().powf(1.5) {
            true => center,
            false => mesh.surface_centroid(),
        }
    }
}
