//! Geometry of an object for resting poses: bounds and convex hull.

use crate::geometry::{Aabb, Pose};
use crate::objects::{Model, Sphere};
use glam::DQuat;

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
}
