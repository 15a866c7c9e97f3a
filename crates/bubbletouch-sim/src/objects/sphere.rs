//! Rigid spheres, of which object models consist.

use crate::geometry::Aabb;
use glam::DVec3;

/// Rigid sphere, given by centre and radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre of the sphere, metres.
    pub center: DVec3,
    /// Radius of the sphere, metres, positive.
    pub radius: f64,
}

impl Sphere {
    /// Returns the bounding box of the sphere, metres.
    pub fn bounds(&self) -> Aabb {
        Aabb {
            min: self.center - DVec3::splat(self.radius),
            max: self.center + DVec3::splat(self.radius),
        }
    }
}
