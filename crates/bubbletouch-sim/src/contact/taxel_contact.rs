//! Contact of one taxel with one object: deflection, normal, and the gradient of the deflection.

use super::law::saturation_limit;
use super::wrench::Wrench;
use crate::world::Taxel;
use glam::DVec3;

/// Cosine between the contact normal and the taxel's axis below which a contact is grazing. The object's surface is then parallel to the axis within 0.6°,
/// and a light touch would cause an arbitrarily large lateral force. If larger, real lateral forces are reduced; if smaller, forces jump as spheres pass by.
pub const GRAZING: f64 = 0.01;

/// Contact of one taxel with the sphere or triangle that pushes the taxel furthest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaxelContact {
    /// Index of the taxel in the layout.
    pub taxel: usize,
    /// Index of the object in the scene.
    pub object: usize,
    /// Index of the sphere in its sphere union, or of the triangle in its mesh.
    pub part: usize,
    /// Deflection δ of the taxel, metres, above 0 and at most the stroke.
    pub deflection: f64,
    /// Deflection that contact with the object requires, not limited to the stroke, metres; larger than `deflection` if the taxel is saturated.
    pub needed: f64,
    /// Contact normal in the patch frame: a unit vector from the object's surface to the taxel at the deflection needed.
    pub normal: DVec3,
    /// Cosine of the angle between the taxel's axis and the reversed contact normal, 0 to 1; 1 for a head-on contact.
    pub cosine: f64,
    /// Contact point on the object, metres, in the patch frame.
    pub point: DVec3,
}

impl TaxelContact {
    /// Returns the gradient of the deflection for a motion of the object in the patch frame. The gradient is `−n_c / (n_c·n)`, with the contact normal n_c
    /// and the taxel axis n. Its length is at most 1 / [`GRAZING`].
    ///
    /// A spring force f of the taxel exerts the frictionless force `−f ∂δ/∂x` on the object, the negative gradient of the energy ½ k δ² \[BT\]. For a
    /// saturated taxel the gradient is computed from the deflection that contact would require without a limit of the stroke.
    pub fn gradient(&self) -> DVec3 {
        self.normal / self.cosine.max(GRAZING)
    }

    /// Returns the force and torque on the object, without friction, for a `force` (N) of the taxel along its axis. The load acts at the contact point.
    pub fn push(&self, force: f64) -> Wrench {
        Wrench::at(self.point, -force * self.gradient())
    }

    /// Returns whether the deflection needed exceeds the stroke; `taxel` is the taxel of this contact.
    pub fn is_saturated(&self, taxel: &Taxel) -> bool {
        self.needed > saturation_limit(taxel.stroke)
    }

    /// Returns whether the contact is grazing, so that its gradient is limited to 1 / [`GRAZING`].
    pub fn is_grazing(&self) -> bool {
        self.cosine < GRAZING
    }
}
