//! Geometry of an object for resting poses: bounds, convex hull and centre of mass.

use super::mass;
use crate::geometry::{Aabb, Pose};
use crate::objects::{Model, Sphere};
use glam::{DQuat, DVec3};

/// Volume relative to area^(3/2) below which a mesh counts as a surface without volume. A ball has 0.094, a plate of 100 × 100 × 0.1 mm 0.0004.
const HOLLOW: f64 = 1e-4;

impl Model {
    /// Returns the bounding box of the object after a rotation about its origin, metres.
    pub(crate) fn turned_bounds(&self, rotation: DQuat) -> Aabb {
        match self {
            Self::Spheres(union) => union.moved(&Pose::from_rotation(rotation)).bounds(),
            Self::Mesh(mesh) => mesh.turned_bounds(rotation),
        }
    }

    /// Returns spheres (points are spheres of zero radius) whose convex hull equals the object's convex hull.
    pub(crate) fn extremes(&self) -> Vec<Sphere> {
        match self {
            Self::Spheres(union) => union.spheres().to_vec(),
            Self::Mesh(mesh) => {
                let corners = mesh.corners();
                let radius = mesh.rounding();
                corners.map(|center| Sphere { center, radius }).collect()
            }
        }
    }

    /// Returns the centre of mass of the homogeneous solid, in the object's frame, metres. A mesh without volume, such as a single surface, is treated as a
    /// surface of constant density.
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
