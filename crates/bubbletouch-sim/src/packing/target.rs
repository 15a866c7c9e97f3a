//! Target of a packing: a mesh, the kind of body that it represents, and the tolerance.

use crate::error::{Error, Result};
use crate::mesh::{Hole, Surface, Triangle, TriangleMesh, Welded};
use glam::DVec3;

/// Name of the mesh in error messages if its file is not known.
pub(super) const MESH: &str = "mesh";

/// Height above a face, as a fraction of the tolerance, at which the code tests whether the face lies inside the solid. Narrower clefts count as closed. If
/// larger, wider clefts are closed; if smaller, rounding decides where faces coincide.
const LIFT: f64 = 1e-3;

/// Kind of body that a mesh represents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// Solid that the mesh encloses; the union of closed parts that overlap. The mesh must have no
    /// holes.
    Solid,
    /// Surface of the mesh without thickness, covered by many spheres as small as the tolerance, centred on the surface. Holes stay open.
    Sheet,
}

/// Mesh to be packed, with the body that it represents and the tolerance.
pub(super) struct Target<'a> {
    pub surface: &'a Surface,
    pub body: Body,
    /// Largest allowed distance between the spheres and the outer surface, metres.
    pub e: f64,
}

impl<'a> Target<'a> {
    /// Creates the target and checks that the mesh meets the requirements of the body.
    pub fn new(surface: &'a Surface, body: Body, tolerance: f64) -> Result<Self> {
        if !(tolerance.is_finite() && tolerance > 0.0) {
            let allowed = "a finite positive length";
            return Err(Error::input("tolerance", format!("{tolerance} m"), allowed));
        }
        if surface.mesh().area() <= 0.0 {
            return Err(Error::input(MESH, "no face with an area", "at least one"));
        }
        if body == Body::Solid {
            check_enclosure(surface.mesh())?;
        }
        // The margin for rounding errors keeps the stated tolerance exact.
        let e = tolerance * (1.0 - 1e-6);
        Ok(Self { surface, body, e })
    }

    /// Returns an upper bound of the radius of a ball inside the mesh, metres.
    pub fn largest_radius(&self) -> f64 {
        0.5 * self.surface.bounds().size().length()
    }

    /// Returns the outward unit normal of the mesh near a surface point; zero if the normal is undefined.
    pub fn normal_at(&self, point: DVec3) -> DVec3 {
        let nearest = self.surface.closest(point, f64::INFINITY);
        let normal = nearest.map(|nearest| self.surface.pseudonormal(&nearest));
        normal.unwrap_or_default().normalize_or_zero()
    }

    /// Returns whether a point of a face, moved outwards by [`LIFT`] times the tolerance, lies in the solid. Faces inside the solid occur where parts
    /// overlap.
    pub fn is_buried(&self, point: DVec3, normal: DVec3) -> bool {
        self.body == Body::Solid && self.surface.contains(point + normal * (LIFT * self.e))
    }

    /// Returns whether the winding number is proved to be constant over a piece of a face that is moved outwards by [`LIFT`] times the tolerance. The proof
    /// is that no face of the mesh crosses the moved piece.
    pub fn is_uncrossed(&self, piece: &Triangle, normal: DVec3) -> bool {
        let lift = normal * (LIFT * self.e);
        let lifted = piece.0.map(|corner| corner + lift);
        !self.surface.may_cross(&Triangle(lifted))
    }

    /// Returns whether a piece of a face is proved to lie inside the solid entirely.
    pub fn buries(&self, piece: &Triangle, normal: DVec3) -> bool {
        self.is_buried(piece.middle(), normal) && self.is_uncrossed(piece, normal)
    }
}

/// Returns an error unless each edge has equally many faces in both directions and the mesh encloses a positive volume.
///
/// The condition is weaker than two faces per edge: if four faces meet at an edge, inside and outside are still defined everywhere.
fn check_enclosure(mesh: &TriangleMesh) -> Result<()> {
    let welded = Welded::new(mesh);
    let n_unbalanced = welded.n_unbalanced();
    if n_unbalanced > 0 {
        let given = not_closed(&Hole::all(mesh, &welded), n_unbalanced);
        let allowed = "a closed mesh, or its surface packed as a sheet";
        return Err(Error::input(MESH, given, allowed));
    }
    let (volume, _) = mesh.volume_and_centroid();
    if volume <= 0.0 {
        let given = format!("an enclosed volume of {:.3} cm³", 1e6 * volume);
        let allowed = "faces counter-clockwise seen from outside, around a positive volume";
        return Err(Error::input(MESH, given, allowed));
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
