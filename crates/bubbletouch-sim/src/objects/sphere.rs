//! Rigid spheres.

use crate::geometry::Aabb;
use glam::DVec3;

/// Rigid sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre, metres.
    pub center: DVec3,
    /// Radius, metres, positive.
    pub radius: f64,
}

impl Sphere {
    /// Returns the bounding box, metres.
    pub fn bounds(&self) -> Aabb {
        Aabb {
            min: self.center - DVec3::splat(self.radius),
            max: self.center + DVec3::splat(self.radius),
        }
    }
}
