//! One taxel on one object: how far it is pushed, and along which way the object feels it.

use super::law::saturation_limit;
use super::wrench::Wrench;
use crate::world::Taxel;
use glam::DVec3;

/// Below this cosine between the contact normal and the taxel's axis a contact is grazing: the object's flank runs along the
/// axis within 0.6°, and a light touch would push the object aside with any force. Larger: pushes aside that are real are
/// cut; smaller: forces jump as spheres pass by.
pub const GRAZING: f64 = 0.01;

/// Contact of one taxel with the sphere or triangle that pushes it furthest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaxelContact {
    /// The taxel's number in the layout.
    pub taxel: usize,
    /// The object's number in the scene.
    pub object: usize,
    /// The number of the sphere in its union, or of the triangle in its mesh.
    pub part: usize,
    /// δ, metres, above 0 to the stroke.
    pub deflection: f64,
    /// How far the object would push it without a stop, metres; more than the deflection if the taxel is saturated.
    pub needed: f64,
    /// n_c in the patch frame: unit, from the object's surface to the taxel, as if it had gone as far as needed.
    pub normal: DVec3,
    /// −n_c·n, 0 to 1: 1 where the object meets the taxel head-on.
    pub cosine: f64,
    /// Where they touch, on the object, metres, in the patch frame.
    pub point: DVec3,
}

impl TaxelContact {
    /// ∂δ/∂x for a motion x of the object in the patch frame: `−n_c / (n_c·n)`, its length bounded by 1 / [`GRAZING`].
    ///
    /// A spring force f on the taxel is `−f ∂δ/∂x` on the object: the frictionless force, −∇ of ½ k δ² \[BT\]. Of a saturated
    /// taxel it is the gradient of the deflection it would need.
    pub fn gradient(&self) -> DVec3 {
        self.normal / self.cosine.max(GRAZING)
    }

    /// What a force (N) of the taxel along its axis is on the object without friction: at the point where they touch, against
    /// the [gradient](Self::gradient).
    pub fn push(&self, force: f64) -> Wrench {
        Wrench::at(self.point, -force * self.gradient())
    }

    /// Whether its taxel (that of the press) would go further than its stroke.
    pub fn is_saturated(&self, taxel: &Taxel) -> bool {
        self.needed > saturation_limit(taxel.stroke)
    }

    /// Whether the bound of the gradient holds it.
    pub fn is_grazing(&self) -> bool {
        self.cosine < GRAZING
    }
}
