//! Torus about the z axis: distance, surface and packing.

use super::Sphere;
use super::fit::{Fit, MAX_SPHERES};
use super::surface_patch::SurfacePatch;
use glam::DVec3;

/// Torus: the points within `tube` of the circle of radius `ring` about z, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Torus {
    pub ring: f64,
    pub tube: f64,
}

impl Torus {
    pub fn distance(&self, point: DVec3) -> f64 {
        let from_axis = point.truncate().length();
        (from_axis - self.ring).hypot(point.z) - self.tube
    }

    /// Returns the support function of the torus: the largest p·direction over its points p, metres.
    pub fn support(&self, direction: DVec3) -> f64 {
        self.ring * direction.truncate().length() + self.tube * direction.length()
    }

    /// Packs the torus with one ring of equally spaced balls that have the radius of the tube.
    ///
    /// Half-way between two of the n balls, the squared distance of a point of the tube from their centres is `tube² + 4 ρ ring sin²(π/2n)`. Here ρ is the
    /// point's distance from the axis. The squared distance is largest on the outer equator and must not exceed `(tube + h)²`, where h is the sum of both
    /// tolerances.
    pub fn pack(&self, fit: Fit, spheres: &mut Vec<Sphere>) {
        let (ring, tube) = (self.ring, self.tube);
        let sine = (0.25 * fit.disc_squared(tube) / (ring * (ring + tube)))
            .sqrt()
            .min(1.0);
        let n = (std::f64::consts::FRAC_PI_2 / sine.asin()).ceil();
        spheres.extend((0..n as usize).take(MAX_SPHERES + 1).map(|i| {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / n).sin_cos();
            fit.swollen(ring * DVec3::new(cos, sin, 0.0), tube)
        }));
    }

    pub fn patches(&self) -> Vec<SurfacePatch> {
        vec![SurfacePatch::torus(self.ring, self.tube)]
    }

    pub fn surface_points(&self, spacing: f64, points: &mut Vec<DVec3>) {
        let tau = std::f64::consts::TAU;
        let n_around = (tau * (self.ring + self.tube) / spacing).ceil().max(8.0);
        let n_tube = (tau * self.tube / spacing).ceil().max(8.0);
        for i in 0..n_around as usize {
            let (sin, cos) = (tau * i as f64 / n_around).sin_cos();
            for j in 0..n_tube as usize {
                let (up, out) = (tau * j as f64 / n_tube).sin_cos();
                let from_axis = self.ring + self.tube * out;
                points.push(DVec3::new(from_axis * cos, from_axis * sin, self.tube * up));
            }
        }
    }
}
