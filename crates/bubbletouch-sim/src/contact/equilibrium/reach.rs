//! Deflection of one taxel by one sphere, with its derivatives with respect to the sphere's motion.

use super::super::law;
use super::super::taxel_contact::GRAZING;
use super::algebra::outer;
use super::curvature::Curvature;
use crate::world::PlacedTaxel;
use glam::{DMat3, DVec3};

/// Deflection of a taxel by a sphere, and the quantities from which it is computed; all in the patch frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// Deflection of the taxel, metres.
    pub deflection: f64,
    /// Vector from the taxel's axis to the sphere's centre, perpendicular to the axis, metres.
    beside: DVec3,
    /// Axis of the taxel, unit vector.
    axis: DVec3,
    /// Sum of the radii of taxel and sphere, metres.
    reach: f64,
}

impl Reach {
    /// Computes the deflection of a taxel by a sphere (in the patch frame), ignoring the substrate. Returns `None` if the sphere does not push the taxel and
    /// cannot push it after a motion of `motion` metres.
    ///
    /// The deflection is `δ = √(S² − b²) − h` for `√(S² − b²) ≥ γS` with γ = [`GRAZING`]. S is the sum of the radii, b the distance of the sphere's centre
    /// from the taxel's axis, and h the height along this axis. Where the sphere's surface is steeper, δ continues along the tangent. A sphere that comes
    /// from the side thus deflects the taxel gradually, with a slope of 1/γ. Forces use the same bound 1/γ of the gradient.
    pub fn new(center: DVec3, radius: f64, taxel: &PlacedTaxel, motion: f64) -> Option<Self> {
        let (axis, reach) = (taxel.axis, taxel.radius + radius);
        let from_rest = center - taxel.center;
        let height = from_rest.dot(axis);
        if height >= reach + motion {
            return None;
        }
        let beside = from_rest - height * axis;
        let b2 = beside.length_squared();
        let q = reach * reach - b2;
        let least = GRAZING * reach;
        let (up, slope) = if q >= least * least {
            (q.sqrt(), b2.sqrt() / q.sqrt())
        } else {
            let slope = (1.0 - GRAZING * GRAZING).sqrt() / GRAZING;
            let edge = reach * (1.0 - GRAZING * GRAZING).sqrt();
            (least - (b2.sqrt() - edge) * slope, slope)
        };
        let deflection = up - height;
        (deflection + motion * (1.0 + slope) > 0.0).then_some(Self {
            deflection,
            beside,
            axis,
            reach,
        })
    }

    /// Returns whether a sphere with this centre is wholly behind the taxel's substrate, whose height along the axis is `taxel.behind`.
    pub fn is_behind(&self, taxel: &PlacedTaxel, center: DVec3) -> bool {
        let height = (center - taxel.center).dot(self.axis);
        let q = self.reach * self.reach - self.beside.length_squared();
        height < taxel.behind && !law::is_in_front(q, height, taxel.behind)
    }

    /// Returns whether the deflection is on the tangent beside the sphere.
    pub fn is_grazing(&self) -> bool {
        let least = GRAZING * self.reach;
        self.reach * self.reach - self.beside.length_squared() < least * least
    }

    /// Returns the derivatives of the deflection with respect to the sphere's centre.
    pub fn derivatives(&self) -> Curvature {
        let Self {
            beside,
            axis,
            reach,
            ..
        } = *self;
        let b2 = beside.length_squared();
        let across = DMat3::IDENTITY - outer(axis, axis);
        if self.is_grazing() {
            let slope = (1.0 - GRAZING * GRAZING).sqrt() / GRAZING;
            let b = b2.sqrt();
            let outward = beside / b;
            let bending = (across - outer(outward, outward)) * (-slope / b);
            return Curvature::of_point((-slope * outward - axis, bending));
        }
        let q = reach * reach - b2;
        let up = q.sqrt();
        let bending = (across + outer(beside, beside) * (1.0 / q)) * (-1.0 / up);
        Curvature::of_point((-beside / up - axis, bending))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creates a taxel at the origin with a radius of 1 mm and a stroke of 5 mm.
    fn taxel(axis: DVec3) -> PlacedTaxel {
        let (x, y) = axis.any_orthonormal_pair();
        PlacedTaxel {
            number: 0,
            center: DVec3::ZERO,
            across: [x, y],
            axis,
            radius: 1e-3,
            behind: -6e-3,
        }
    }

    #[test]
    fn derivatives_are_those_of_the_deflection() {
        let axis = DVec3::new(0.2, -0.3, 0.9).normalize();
        let taxel = taxel(axis);
        let at = |c: DVec3| Reach::new(c, 4e-3, &taxel, 0.0).unwrap();
        let side = axis.any_orthonormal_vector();
        // The last case is on the tangent beside the sphere.
        for (beside, height) in [
            (1e-3, 2e-3),
            (3e-3, -1e-3),
            (4.9e-3, -2e-3),
            (4.9999e-3, -3e-3),
        ] {
            let c = beside * side + height * axis;
            let found = at(c).derivatives();
            assert_eq!(at(c).is_grazing(), beside > 4.99e-3);
            let step = 1e-8;
            for k in 0..3 {
                let e = step * DVec3::AXES[k];
                let slope = (at(c + e).deflection - at(c - e).deflection) / (2.0 * step);
                let error = (slope - found.gradient[k]).abs();
                assert!(
                    error < 1e-4 * found.gradient.length(),
                    "{slope} {}",
                    found.gradient
                );
                let gradient = |c| at(c).derivatives().gradient;
                let bend = (gradient(c + e) - gradient(c - e)) / (2.0 * step);
                let error = (bend - found.bending.col(k)).length();
                assert!(error < 1e-3 * found.bending.col(k).length() + 1.0, "{bend}");
            }
        }
    }

    #[test]
    fn away_from_the_flank_it_is_the_formula() {
        let c = DVec3::new(1e-3, 2e-3, 3e-3);
        let found = Reach::new(c, 4e-3, &taxel(DVec3::Z), 0.0).unwrap();
        let needed = (25e-6 - 5e-6_f64).sqrt() - 3e-3;
        assert!((found.deflection - needed).abs() < 1e-18);
        let behind = c - 15e-3 * DVec3::Z;
        let found = Reach::new(behind, 4e-3, &taxel(DVec3::Z), 0.0).unwrap();
        assert!(found.is_behind(&taxel(DVec3::Z), behind));
    }

    #[test]
    fn what_a_motion_could_bring_into_contact_is_not_left_out() {
        let taxel = taxel(DVec3::Z);
        let mut n_near = 0;
        for k in 0..2000 {
            let turn = 0.01 * f64::from(k);
            let c = DVec3::new(
                5.05e-3 * turn.sin(),
                0.0,
                5.05e-3 * turn.cos() * (turn * 0.1).cos(),
            );
            let moved = c + 1e-4 * DVec3::new((7.0 * turn).sin(), 0.0, (7.0 * turn).cos());
            if Reach::new(moved, 4e-3, &taxel, 0.0).is_some() && c.z > -5.9e-3 {
                n_near += usize::from(Reach::new(c, 4e-3, &taxel, 0.0).is_none());
                assert!(
                    Reach::new(c, 4e-3, &taxel, 1.01e-4).is_some(),
                    "{c} {moved}"
                );
            }
        }
        assert!(n_near > 20, "{n_near}");
    }
}
