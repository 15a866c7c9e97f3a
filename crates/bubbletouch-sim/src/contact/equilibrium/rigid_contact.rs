//! Contact of a free object's part with a rigid counterpart.

use super::algebra::outer;
use super::curvature::Curvature;
use glam::{DMat3, DVec3};

/// Rigid counterpart that a part of a free object touches: a sphere, or a part of a mesh by its number
/// ([`MeshFeatures`](crate::mesh::MeshFeatures)).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Touched {
    /// Plane, given by its index in the list of planes of the ground.
    Plane(usize),
    /// Part of an obstacle: index of the obstacle, and number of the part.
    Obstacle(usize, usize),
    /// Part of another free object: index of the object, and number of the part.
    Object(usize, usize),
}

/// Penetration of a part into a rigid counterpart, and the quantities on which the penetration depends; in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touching {
    /// Derivatives of the penetration.
    pub curvature: Curvature,
    /// Distance from the end of the pair's arm to the contact point, towards the counterpart, metres.
    pub inset: f64,
    /// Numbers of the touching parts of the body and its counterpart; `None` if the key of the pair contains them.
    pub parts: Option<[u32; 2]>,
    /// Index of the touched body, and the arm from its centre of mass; `None` if the counterpart is fixed.
    pub other: Option<(u32, DVec3)>,
}

impl Touching {
    /// Creates the contact of a sphere of `radius` metres with a sphere or a plane. `normal` points from the counterpart to the sphere, and `distance` is the
    /// distance of the two centres, metres; infinite for a plane.
    pub fn of_sphere(
        radius: f64,
        normal: DVec3,
        distance: f64,
        other: Option<(u32, DVec3)>,
    ) -> Self {
        let bending = (DMat3::IDENTITY - outer(normal, normal)) * (-1.0 / distance);
        Self {
            curvature: Curvature::of_point((-normal, bending)),
            inset: radius,
            parts: None,
            other,
        }
    }
}
