//! What a table and gravity need to know of an object, whatever it is made of.

use super::mass;
use crate::geometry::{Aabb, Pose};
use crate::objects::{MeshModel, Model, Sphere, SphereUnion};
use glam::{DQuat, DVec3};

/// Below this share of area^(3/2) a mesh holds no volume worth the name: a ball holds 0.094, a sheet of 100 × 100 × 0.1 mm 0.0004.
const HOLLOW: f64 = 1e-4;

/// Something that can lie on a table.
pub trait Body {
    /// The box around it after a turn about its origin, metres.
    fn turned_bounds(&self, rotation: DQuat) -> Aabb;
    /// Spheres, or points as spheres of no radius, whose convex hull is the body's.
    fn extremes(&self) -> Vec<Sphere>;
    /// As a homogeneous solid, in its own frame, metres.
    fn center_of_mass(&self) -> DVec3;
}

impl Body for SphereUnion {
    fn turned_bounds(&self, rotation: DQuat) -> Aabb {
        self.moved(&Pose::from_rotation(rotation)).bounds()
    }

    fn extremes(&self) -> Vec<Sphere> {
        self.spheres().to_vec()
    }

    fn center_of_mass(&self) -> DVec3 {
        mass::center_of_mass(self)
    }
}

/// The volume decides where a mesh has its mass; a mesh without one, such as a sheet, is as heavy as its surface.
impl Body for MeshModel {
    fn turned_bounds(&self, rotation: DQuat) -> Aabb {
        Self::turned_bounds(self, rotation)
    }

    fn extremes(&self) -> Vec<Sphere> {
        let point = |center| Sphere {
            center,
            radius: 0.0,
        };
        self.corners().map(point).collect()
    }

    fn center_of_mass(&self) -> DVec3 {
        let (volume, center) = self.mesh().volume_and_centroid();
        if volume.abs() > HOLLOW * self.mesh().area().powf(1.5) {
            center
        } else {
            self.mesh().surface_centroid()
        }
    }
}

impl Body for Model {
    fn turned_bounds(&self, rotation: DQuat) -> Aabb {
        match self {
            Self::Spheres(spheres) => spheres.turned_bounds(rotation),
            Self::Mesh(mesh) => mesh.turned_bounds(rotation),
        }
    }

    fn extremes(&self) -> Vec<Sphere> {
        match self {
            Self::Spheres(spheres) => spheres.extremes(),
            Self::Mesh(mesh) => mesh.extremes(),
        }
    }

    fn center_of_mass(&self) -> DVec3 {
        match self {
            Self::Spheres(spheres) => spheres.center_of_mass(),
            Self::Mesh(mesh) => mesh.center_of_mass(),
        }
    }
}
