//! Packing of a solid with spheres, within a stated surface error.
//!
//! Let e be the tolerance. Each sphere is the largest ball inside the solid that touches its surface at some point (the foot), with radius r, enlarged by e/2.
//! No point of it lies more than e/2 outside. The sphere comes within e of every surface point p with |p − c| ≤ r + h, h = 3e/2. The feet are chosen so that
//! the spheres cover the whole surface. On a flat face a ball covers a disc of radius sqrt(h(2r + h)) around its foot. Therefore few large balls suffice. At a
//! right-angled edge a ball needs r ≤ h/(√2 − 1) to reach the edge. Each form has its own closed layout of feet (`block`, `lathe`, `sphere_sweep`, `torus`), or
//! cells that are divided until they are covered (`prism`).
//!
//! If shapes are subtracted, cells of all surfaces are divided in this way (`difference`).
//!
//! With e/2 outside, bumps and hollows of the spheres nearly cancel (`fit`). The mean surface of the spheres equals the surface of the
//! solid, as for packed meshes ([`crate::packing`]). A ball is represented by one sphere, and so are the balls of a sphere sweep; these spheres
//! are not enlarged.

use super::difference::pack_difference;
use super::fit::{Fit, MAX_SPHERES};
use super::{Represented, Solid, Sphere, SphereUnion};
use crate::error::{Error, Result};

/// Packs a solid with spheres whose union approximates it within `tolerance` (metres, positive).
///
/// No sphere protrudes from the solid by more than half of `tolerance`. No point of the solid's outer surface lies more than `tolerance` outside the spheres.
/// `surface_error` measures both distances. On average the surfaces of solid and spheres have equal height. A solid that is a ball is represented by one
/// sphere. Equal inputs give equal spheres, in the order of the parts.
///
/// # Errors
/// If the tolerance is not positive, or is so small that a part would need more than [`MAX_SPHERES`].
pub fn pack(solid: &Solid, tolerance: f64) -> Result<SphereUnion> {
    if !(tolerance.is_finite() && tolerance > 0.0) {
        let allowed = "a finite positive length";
        return Err(Error::input(
            "surface error",
            format!("{tolerance} m"),
            allowed,
        ));
    }
    // The margin for rounding errors keeps the stated tolerance exact.
    let fit = Fit::within(tolerance * (1.0 - 1e-6));
    let too_fine = |what: &str, allowed: &str| {
        let tolerance = 1e3 * tolerance;
        let given =
            format!("{tolerance:e} mm, which takes more than {MAX_SPHERES} spheres for {what}");
        Error::input("surface error", given, allowed)
    };
    let spheres = match solid.cuts().is_empty() {
        true => pack_parts(solid, fit)
            .map_err(|part| too_fine(&format!("part {}", part + 1), "a larger surface error"))?,
        false => pack_difference(solid, fit).ok_or_else(|| {
            too_fine(
                "a solid less other shapes, or walls too thin for it",
                "a larger surface error, or subtracted shapes that leave thicker walls",
            )
        })?,
    };
    Ok(SphereUnion::new(spheres)?.representing(Represented::Solid(solid.clone())))
}

impl Solid {
    /// Packs the solid with spheres within `tolerance` (metres), as the function `pack` does.
    ///
    /// # Errors
    /// If the tolerance is invalid or too small.
    pub fn pack(&self, tolerance: f64) -> Result<SphereUnion> {
        pack(self, tolerance)
    }
}

/// Returns the spheres of all parts without buried ones, or the index of a part that needs more than [`MAX_SPHERES`].
fn pack_parts(solid: &Solid, fit: Fit) -> std::result::Result<Vec<Sphere>, usize> {
    let mut kept = Vec::new();
    for (index, part) in solid.parts().iter().enumerate() {
        let spheres = part.resolves(fit).then(|| part.pack(fit));
        let spheres = spheres.filter(|spheres| spheres.len() <= MAX_SPHERES);
        let spheres = spheres.ok_or(index)?.into_iter();
        kept.extend(spheres.filter(|s| !is_buried(s, index, solid, fit)));
    }
    Ok(kept)
}

/// Returns whether a sphere is not needed, because the whole surface that it covers lies inside another part.
///
/// A sphere covers surface points within its radius plus the allowed gap. If two parts are equal, the spheres of the later part are not needed.
fn is_buried(sphere: &Sphere, part: usize, solid: &Solid, fit: Fit) -> bool {
    let others = solid.parts().iter().enumerate().filter(|&(i, _)| i != part);
    let reach = sphere.radius + fit.inside;
    others
        .map(|(_, other)| other.distance(sphere.center))
        .any(|distance| distance < -reach)
}
