//! Torus about the z axis: distance, surface and packing.

use super::Sphere;
use super::fit::Fit;
use super::lathe::around_axis;
use super::solid::Form;
use super::surface_patch::SurfacePatch;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Torus: the points within `tube` of the circle of radius `ring` about z, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Torus {
    pub ring: f64,
    pub tube: f64,
}

impl Form for Torus {
    fn distance(&self, point: DVec3) -> f64 {
        let from_axis = point.truncate().length();
        (from_axis - self.ring).hypot(point.z) - self.tube
    }

    fn support(&self, direction: DVec3) -> f64 {
        self.ring * direction.truncate().length() + self.tube * direction.length()
    }

    fn volume_and_center(&self) -> (f64, DVec3) {
        (
            2.0 * PI * PI * self.ring * self.tube * self.tube,
            DVec3::ZERO,
        )
    }

    /// Packs the torus with one ring of equally spaced balls that have the radius of the tube.
    ///
    /// Half-way between two of the n balls, the squared distance of a point of the tube from their centres is `tube² + 4 ρ ring sin²(π/2n)`. Here ρ is the
    /// point's distance from the axis. The squared distance is largest on the outer equator and must not exceed `(tube + h)²`, where h is the sum of both
    /// tolerances.
    fn pack(&self, fit: Fit, spheres: &mut Vec<Sphere>) {
        let (ring, tube) = (self.ring, self.tube);
        let sine = (0.25 * fit.disc_squared(tube) / (ring * (ring + tube)))
            .sqrt()
            .min(1.0);
        let n = (FRAC_PI_2 / sine.asin()).ceil();
        let centers = around_axis(DVec2::new(ring, 0.0), n);
        spheres.extend(centers.map(|center| fit.swollen(center, tube)));
    }

    fn patches(&self) -> Vec<SurfacePatch> {
        vec![SurfacePatch::torus(self.ring, self.tube)]
    }
}
