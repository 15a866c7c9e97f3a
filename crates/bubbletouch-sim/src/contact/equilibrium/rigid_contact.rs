//! Contact of a free object's sphere with a rigid counterpart.

use glam::{DMat3, DVec3};

/// Rigid counterpart that a sphere of a free object touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Touched {
    /// Plane, given by its index in the list of planes of the ground.
    Plane(usize),
    /// Sphere of an obstacle: index of the obstacle, and index of the sphere.
    Obstacle(usize, usize),
    /// Sphere of another free object: index of the object, and index of the sphere.
    Object(usize, usize),
}

/// Penetration of a sphere into a rigid counterpart, and the quantities on which the penetration depends; in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touching {
    /// Unit normal, pointing from the counterpart to the sphere.
    pub normal: DVec3,
    /// Distance between the centres of two spheres, metres; infinite for a plane.
    pub distance: f64,
    /// Index of the touched body, and the vector from its centre of mass to the centre of its sphere; `None` if the counterpart is fixed.
    pub other: Option<(u32, DVec3)>,
}

impl Touching {
    /// Returns the first and second (1/m) derivative of the penetration with respect to the motion of the sphere's centre relative to the counterpart.
    pub fn derivatives(&self) -> (DVec3, DMat3) {
        let n = self.normal;
        let along = DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        (-n, (DMat3::IDENTITY - along) * (-1.0 / self.distance))
    }
}
