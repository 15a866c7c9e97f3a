//! Contact of a sphere of a free object with something rigid.

use glam::{DMat3, DVec3};

/// What a sphere of a free object touches that is rigid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Touched {
    /// A plane, by its number.
    Plane(usize),
    /// An obstacle, by its number, and one of its spheres.
    Obstacle(usize, usize),
    /// Another free object, by its number, and one of its spheres.
    Object(usize, usize),
}

/// How far a sphere is inside of something rigid, and what that depends on; in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touching {
    /// Unit, out of it to the sphere.
    pub normal: DVec3,
    /// Between the middles of two spheres, metres; endless from a plane.
    pub distance: f64,
    /// The body that the sphere touches, and where the centre of its sphere is from its centre of mass; `None` of what does not move.
    pub other: Option<(u32, DVec3)>,
}

impl Touching {
    /// ∂δ/∂c and ∂²δ/∂c² (1/m) by how the sphere's centre moves, less how the other one's does.
    pub fn derivatives(&self) -> (DVec3, DMat3) {
        let n = self.normal;
        let along = DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        (-n, (DMat3::IDENTITY - along) * (-1.0 / self.distance))
    }
}
