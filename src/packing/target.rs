//! What is packed: a mesh, what of it counts, and how near the spheres must come.

use super::ball::Ball;
use crate::error::{Error, Result};
use crate::mesh::{Side, Surface, Triangle, TriangleMesh, Welded};
use glam::DVec3;

/// What a mesh stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// The solid that it encloses. It must have no holes.
    Solid,
    /// Itself, without thickness: spheres as small as the tolerance, centred on it. Holes stay open; the spheres are many.
    Sheet,
}

/// A mesh that can be packed.
pub(super) struct Target<'a> {
    pub surface: &'a Surface,
    pub body: Body,
    /// How far spheres may be from the outer surface, metres.
    pub e: f64,
}

impl<'a> Target<'a> {
    /// Checks that the mesh has what the body needs.
    pub fn new(surface: &'a Surface, body: Body, tolerance: f64) -> Result<Self> {
        if !(tolerance.is_finite() && tolerance > 0.0) {
            return Err(Error::input(
                "tolerance",
                format!("{tolerance} m"),
                "a finite positive length",
            ));
        }
        if surface.mesh().area() <= 0.0 {
            return Err(Error::input("mesh", "no face with an area", "at least one"));
        }
        if body == Body::Solid {
            check_enclosure(surface.mesh())?;
        }
        // Leaves rounding errors a place, so that what is promised is kept to the last digit.
        let e = tolerance * (1.0 - 1e-6);
        Ok(Self { surface, body, e })
    }

    /// No ball is larger, metres.
    pub fn largest_radius(&self) -> f64 {
        0.5 * self.surface.bounds().size().length()
    }

    /// The largest ball that touches the surface from inside at a point; on a sheet around it.
    pub fn ball_at(&self, foot: DVec3, normal: DVec3) -> Ball {
        let largest = Ball::largest(self, foot, -normal, 0.0, self.largest_radius());
        largest.unwrap_or(Ball::on_surface(foot))
    }

    /// The largest ball that touches the surface where it is nearest to a point beside the centre of another ball; on a
    /// sheet around that place. `None` if the point is outside a solid.
    pub fn ball_beside(&self, ball: &Ball, shift: DVec3) -> Option<Ball> {
        let center = ball.center + shift;
        let nearest = self.surface.closest(center, f64::INFINITY)?;
        if self.body == Body::Sheet {
            return Some(Ball::on_surface(nearest.point));
        }
        let is_inside = shift.length() < ball.depth || !self.surface.is_outside(center, &nearest);
        if nearest.distance <= 0.0 || !is_inside {
            return None;
        }
        let inward = (center - nearest.point) / nearest.distance;
        Ball::largest(self, nearest.point, inward, 0.0, self.largest_radius())
    }

    /// Whether a ball's centre is inside a solid, or on the surface. Where a mesh cuts through itself, faces may look inwards.
    pub fn holds_center(&self, ball: &Ball) -> bool {
        self.body == Body::Sheet || ball.depth == 0.0 || self.surface.contains(ball.center)
    }

    /// The outward unit normal near a point of the surface; zero where there is none.
    pub fn normal_at(&self, point: DVec3) -> DVec3 {
        let nearest = self.surface.closest(point, f64::INFINITY);
        let normal = nearest.map(|nearest| self.surface.pseudonormal(&nearest));
        normal.unwrap_or_default().normalize_or_zero()
    }

    /// Whether a face of a solid lies inside other parts of the mesh: its middle and three points near its corners do,
    /// when they are lifted off it by a thousandth of the tolerance.
    pub fn is_buried(&self, triangle: &Triangle, normal: DVec3) -> bool {
        let middle = triangle.middle();
        let near_corners = triangle.0.map(|corner| corner.lerp(middle, 0.2));
        let points = [middle, near_corners[0], near_corners[1], near_corners[2]];
        let lift = normal * (1e-3 * self.e);
        self.body == Body::Solid && points.iter().all(|&p| self.surface.contains(p + lift))
    }
}

/// An error unless every edge is passed as often in one direction as in the other, and the enclosed volume is positive.
///
/// Weaker than two faces an edge: where four faces meet in one, inside and outside are still known everywhere.
fn check_enclosure(mesh: &TriangleMesh) -> Result<()> {
    let welded = Welded::new(mesh);
    let balance = |sides: &[Side]| -> i32 {
        let signs = sides
            .iter()
            .map(|side| if side.is_forward { 1 } else { -1 });
        signs.sum()
    };
    let n_open = welded.edges().filter(|sides| balance(sides) != 0).count();
    if n_open > 0 {
        return Err(Error::input(
            "mesh",
            format!("{n_open} edges at holes or between faces that disagree about the outside"),
            "a closed mesh, or its surface packed as a sheet",
        ));
    }
    let (volume, _) = mesh.volume_and_centroid();
    if volume <= 0.0 {
        return Err(Error::input(
            "mesh",
            format!("an enclosed volume of {:.3} cm³", 1e6 * volume),
            "faces counter-clockwise seen from outside, around a positive volume",
        ));
    }
    Ok(())
}
