//! Contact of a sphere of a free object with something rigid.

use glam::{DMat3, DVec3};

/// Rigid counterpart of a sphere of a free object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Touched {
    /// Number of a plane.
    Plane(usize),
    /// Number of an obstacle, and number of one of its spheres.
    Obstacle(usize, usize),
    /// Number of another free object, and number of one of its spheres.
    Object(usize, usize),
}

/// Penetration of a sphere into something rigid, and the quantities on which it depends; in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touching {
    /// Unit normal, from the counterpart to the sphere.
    pub normal: DVec3,
    /// Distance between the centres of two spheres, metres; infinite for a plane.
    pub distance: f64,
    /// Index of the touched body, and the vector from its centre of mass to the centre of its sphere; `None` for a fixed counterpart.
    pub other: Option<(u32, DVec3)>,
}

impl Touching {
    /// Returns ∂δ/∂c and ∂²δ/∂c² (1/m) by the motion of the sphere's centre relative to the counterpart.
    pub fn derivatives(&self) -> (DVec3, DMat3) {
        let n = self.normal;
        let along = DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        (-n, (DMat3::IDENTITY - along) * (-1.0 / self.distance))
    }
}
