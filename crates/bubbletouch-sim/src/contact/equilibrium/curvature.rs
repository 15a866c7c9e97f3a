//! Derivatives of the deflection of a contact with respect to the motion of a body.

use glam::{DMat3, DVec3};

/// First and second derivatives of the deflection of a pair.
///
/// Let w be the displacement of the body's material point at the pair's arm, relative to the counterpart, and θ the rotation of the body. For θ = 0 the
/// deflection changes by `gradient·w + ½ w·bending w`. The rotation adds the centripetal term of the arm (`add_turning`), and `θ·turning w` where the
/// direction of contact turns with the body, as on a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curvature {
    /// Gradient of the deflection, dimensionless.
    pub gradient: DVec3,
    /// Second derivative with respect to the displacement, 1/m.
    pub bending: DMat3,
    /// Mixed second derivatives with respect to a rotation and the displacement, for the body and for its counterpart, dimensionless.
    pub turning: [DMat3; 2],
}

impl Curvature {
    /// Returns the derivatives for a contact that is a function of one displacement, such as contact with a sphere.
    pub fn of_point((gradient, bending): (DVec3, DMat3)) -> Self {
        Self {
            gradient,
            bending,
            turning: [DMat3::ZERO; 2],
        }
    }

    /// Returns the derivatives in a rotated frame.
    pub fn turned(&self, rotation: &DMat3) -> Self {
        let turned = |matrix: &DMat3| *rotation * *matrix * rotation.transpose();
        Self {
            gradient: *rotation * self.gradient,
            bending: turned(&self.bending),
            turning: self.turning.each_ref().map(turned),
        }
    }
}
