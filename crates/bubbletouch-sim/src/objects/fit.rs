//! Tolerances of a packing: maximum distances between the spheres' surface and the surface of the solid.

use super::Sphere;
use glam::DVec3;

/// Maximum number of spheres per part of a packing. If larger, packings need more than 100 MB and a touch takes hours; if smaller, fine tolerances of large
/// parts are rejected.
pub const MAX_SPHERES: usize = 2_000_000;

/// Allowed distances between the surface of the spheres and the surface of the solid, outside and inside the solid, metres.
///
/// A ball of radius r inside the solid that touches its surface is enlarged by the tolerance `outside`. Let c be the centre of the resulting sphere and h =
/// outside + inside. The sphere comes within the tolerance `inside` of every surface point p with |p − c| ≤ r + h.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// Largest height to which a sphere may protrude from the solid, metres.
    pub outside: f64,
    /// Largest distance that the solid's surface may have from the nearest sphere, metres.
    pub inside: f64,
}

impl Fit {
    /// Creates the tolerances of a packing: half of `tolerance` outside the solid, and all of it inside. On a flat cell or along an edge, the mean of the
    /// spheres' surface is then the surface of the solid.
    ///
    /// On a square cell (or an interval), the sphere's height above the surface is outside − h·t², with h = outside + inside. Here t is the distance from the
    /// middle relative to half the side; in a square, t² is the mean over the two sides. The mean of t² over the cell is 1/3. If the tolerance outside is
    /// larger, objects are too large; if it is smaller, more spheres are needed.
    pub fn within(tolerance: f64) -> Self {
        Self {
            outside: 0.5 * tolerance,
            inside: tolerance,
        }
    }

    /// Returns the sum of both tolerances, metres. An enlarged ball covers the surface points whose distance from its centre exceeds the ball's radius by at
    /// most this sum.
    pub fn reach(&self) -> f64 {
        self.outside + self.inside
    }

    /// Returns the radius of the disc that an enlarged ball covers on a flat face, around the point where the ball touches the face; metres. `radius` is the
    /// ball's radius before enlargement.
    pub fn disc(&self, radius: f64) -> f64 {
        self.disc_squared(radius).sqrt()
    }

    /// Returns the squared radius of the disc that an enlarged ball covers on a flat face, m²; `radius` is the ball's radius before enlargement.
    pub fn disc_squared(&self, radius: f64) -> f64 {
        self.reach() * (2.0 * radius + self.reach())
    }

    /// Returns the tolerances for balls that are not enlarged, because their surface is the solid's surface.
    pub fn unswollen(&self) -> Self {
        Self {
            outside: 0.0,
            ..*self
        }
    }

    /// Returns the sphere for a ball that must cover surface points up to the distance `farthest` from its centre. The ball is enlarged only as far as this
    /// requires.
    pub fn covering(&self, center: DVec3, radius: f64, farthest: f64) -> Sphere {
        let needed = ((farthest - radius) / self.reach()).clamp(0.0, 1.0);
        Sphere {
            center,
            radius: radius + needed * self.outside,
        }
    }

    /// Returns the sphere for a ball that touches the surface from inside; the ball is enlarged by the whole tolerance outside the solid.
    pub fn swollen(&self, center: DVec3, radius: f64) -> Sphere {
        Sphere {
            center,
            radius: radius + self.outside,
        }
    }
}
