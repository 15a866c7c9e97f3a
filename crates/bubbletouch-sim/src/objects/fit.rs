//! How near spheres come to the surface that they stand for.

use super::Sphere;
use glam::DVec3;

/// Largest number of spheres that [`pack`](super::pack) makes of a part. Larger: packings take more than 100 MB, and a touch takes hours; smaller:
/// fine tolerances of large parts are refused.
pub const MAX_SPHERES: usize = 2_000_000;

/// How far the surface of the spheres may lie outside and inside that of the solid, metres.
///
/// A ball of radius r inside the solid that touches its surface is swollen by [`outside`](Self::outside). Such a sphere comes
/// within [`inside`](Self::inside) of every surface point p with |p − c| ≤ r + h, h = outside + inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// How far a sphere reaches outside, at most.
    pub outside: f64,
    /// How far the surface lies outside all spheres, at most.
    pub inside: f64,
}

impl Fit {
    /// Half of the tolerance outside, all of it inside: over a flat cell, or along an edge, the spheres are as often above the
    /// surface as below it.
    ///
    /// At t times the half side of a square cell (or of an interval) the sphere stands outside − h·t² above the surface, t² summed
    /// over both sides and divided by 2 in a square: its mean is 1/3. More outside: objects feel too large; less: more spheres.
    pub fn within(tolerance: f64) -> Self {
        Self {
            outside: 0.5 * tolerance,
            inside: tolerance,
        }
    }

    /// h: a swollen ball covers the surface points within r + h of its centre.
    pub fn reach(&self) -> f64 {
        self.outside + self.inside
    }

    /// On a flat face a swollen ball of tangent radius r covers a disc of this radius around its foot.
    pub fn disc(&self, radius: f64) -> f64 {
        self.disc_squared(radius).sqrt()
    }

    /// (r + h)² − r².
    pub fn disc_squared(&self, radius: f64) -> f64 {
        self.reach() * (2.0 * radius + self.reach())
    }

    /// The same while nothing is swollen: for balls that are surface themselves.
    pub fn unswollen(&self) -> Self {
        Self {
            outside: 0.0,
            ..*self
        }
    }

    /// The sphere of a ball that is to cover surface points this far from its centre, at most r + h: what it need not
    /// reach it is not swollen for.
    pub fn covering(&self, center: DVec3, radius: f64, farthest: f64) -> Sphere {
        let needed = ((farthest - radius) / self.reach()).clamp(0.0, 1.0);
        Sphere {
            center,
            radius: radius + needed * self.outside,
        }
    }

    /// The sphere of a ball that touches the surface from inside.
    pub fn swollen(&self, center: DVec3, radius: f64) -> Sphere {
        Sphere {
            center,
            radius: radius + self.outside,
        }
    }
}
