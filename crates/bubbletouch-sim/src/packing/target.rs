//! What is packed: a mesh, what of it counts, and how near the spheres must come.

use crate::error::{Error, Result};
use crate::mesh::{Hole, Surface, Triangle, TriangleMesh, Welded};
use glam::DVec3;

/// What errors about a mesh begin with, where its file is not known.
pub(super) const MESH: &str = "mesh";

/// How far above a face, as a share of the tolerance, it is asked whether the face lies inside the solid: clefts that are
/// narrower count as closed. Larger: wider ones do; smaller: rounding decides where faces lie on each other.
const LIFT: f64 = 1e-3;

/// What a mesh stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// The [solid](crate::mesh#the-solid-of-a-mesh) that it encloses: of closed parts that overlap their union. It must have no
    /// holes.
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
            return Err(Error::input(MESH, "no face with an area", "at least one"));
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

    /// The outward unit normal near a point of the surface; zero where there is none.
    pub fn normal_at(&self, point: DVec3) -> DVec3 {
        let nearest = self.surface.closest(point, f64::INFINITY);
        let normal = nearest.map(|nearest| self.surface.pseudonormal(&nearest));
        normal.unwrap_or_default().normalize_or_zero()
    }

    /// Whether a point of a face of a solid looks into the solid: it does when it is lifted off the face by [`LIFT`].
    pub fn is_buried(&self, point: DVec3, normal: DVec3) -> bool {
        self.body == Body::Solid && self.surface.contains(point + normal * (LIFT * self.e))
    }

    /// Whether the winding number is proved to be the same all over a part of a face, when it is lifted off it by [`LIFT`]: no
    /// face of the mesh crosses it there.
    pub fn is_uncrossed(&self, piece: &Triangle, normal: DVec3) -> bool {
        let lift = normal * (LIFT * self.e);
        let lifted = piece.0.map(|corner| corner + lift);
        !self.surface.may_cross(&Triangle(lifted))
    }

    /// Whether a part of a face is proved to look into the solid all over.
    pub fn buries(&self, piece: &Triangle, normal: DVec3) -> bool {
        self.is_buried(piece.middle(), normal) && self.is_uncrossed(piece, normal)
    }
}

/// An error unless every edge is passed as often in one direction as in the other, and the enclosed volume is positive.
///
/// Weaker than two faces an edge: where four faces meet in one, inside and outside are still known everywhere.
fn check_enclosure(mesh: &TriangleMesh) -> Result<()> {
    let welded = Welded::new(mesh);
    let n_unbalanced = welded.n_unbalanced();
    if n_unbalanced > 0 {
        return Err(Error::input(
            MESH,
            not_closed(&Hole::all(mesh, &welded), n_unbalanced),
            "a closed mesh, or its surface packed as a sheet",
        ));
    }
    let (volume, _) = mesh.volume_and_centroid();
    if volume <= 0.0 {
        return Err(Error::input(
            MESH,
            format!("an enclosed volume of {:.3} cm³", 1e6 * volume),
            "faces counter-clockwise seen from outside, around a positive volume",
        ));
    }
    Ok(())
}

fn not_closed(holes: &[Hole], n_unbalanced: usize) -> String {
    let widest = holes.iter().map(|hole| hole.width).fold(0.0, f64::max);
    let widest = format!("{:.2} mm wide", 1e3 * widest);
    match holes.len() {
        0 => format!("{n_unbalanced} edges between faces that disagree about the outside"),
        1 => format!("a hole {widest}"),
        n => format!("{n} holes, at most {widest}"),
    }
}
