//! Tolerances of a packing: how far spheres may be from the surface of the solid.

use super::Sphere;
use glam::DVec3;

/// Maximum number of spheres per part in [`pack`](super::pack). If the value is larger, packings need more than 100 MB and a touch takes hours; if the value
/// is smaller, fine tolerances of large parts are rejected.
pub const MAX_SPHERES: usize = 2_000_000;

/// Allowed distances of the spheres' surface outside and inside the surface of the solid, metres.
///
/// A ball of radius r inside the solid that touches its surface is enlarged by [`outside`](Self::outside). The resulting sphere comes
/// within [`inside`](Self::inside) of every surface point p with |p − c| ≤ r + h, h = outside + inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// Maximum distance that a sphere reaches outside the solid.
    pub outside: f64,
    /// Maximum distance of the solid's surface outside all spheres.
    pub inside: f64,
}

impl Fit {
    /// Returns half of the tolerance outside and all of it inside. On a flat cell or along an edge, the mean of the spheres' surface is then
    /// the surface of the solid.
    ///
    /// At t times the half side of a square cell (or of an interval) the sphere is outside − h·t² above the surface, with t² summed
    /// over both sides and divided by 2 in a square; its mean is 1/3. If more is outside, objects are too large; if less is outside, more spheres are
    /// needed.
    pub fn within(tolerance: f64) -> Self {
        Self {
            outside: 0.5 * tolerance,
            inside: tolerance,
        }
    }

    /// Returns h: an enlarged ball covers the surface points within r + h of its centre.
    pub fn reach(&self) -> f64 {
        self.outside + self.inside
    }

    /// Returns the radius of the disc around its foot that an enlarged ball of tangent radius r covers on a flat face.
    pub fn disc(&self, radius: f64) -> f64 {
        self.disc_squared(radius).sqrt()
    }

    /// Returns (r + h)² − r².
    pub fn disc_squared(&self, radius: f64) -> f64 {
        self.reach() * (2.0 * radius + self.reach())
    }

    /// Returns the tolerances without enlargement, for balls that are surface themselves.
    pub fn unswollen(&self) -> Self {
        Self {
            outside: 0.0,
            ..*self
        }
    }

    /// Returns the sphere of a ball that covers surface points up to `farthest` from its centre, at most r + h. The ball is enlarged only as far
    /// as this requires.
    pub fn covering(&self, center: DVec3, radius: f64, farthest: f64) -> Sphere {
        let needed = ((farthest - radius) / self.reach()).clamp(0.0, 1.0);
        Sphere {
            center,
            radius: radius + needed * self.outside,
        }
    }

    /// Returns the enlarged sphere of a ball that touches the surface from inside.
    pub fn swollen(&self, center: DVec3, radius: f64) -> Sphere {
        Sphere {
            center,
            radius: radius + self.outside,
        }
    }
}
