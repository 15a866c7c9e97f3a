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
        return Err(Error::input(
            "surface error",
            format!("{tolerance} m"),
            "a finite positive length",
        ));
    }
    // The margin for rounding errors keeps the stated tolerance exact.
    let fit = Fit::within(tolerance * (1.0 - 1e-6));
    if !solid.cuts().is_empty() {
        return pack_less(solid, tolerance, fit);
    }
    let mut kept = Vec::new();
    for (index, part) in solid.parts().iter().enumerate() {
        let packed = part.resolves(fit).then(|| part.pack(fit));
        let Some(spheres) = packed.filter(|spheres| spheres.len() <= MAX_SPHERES) else {
            return Err(Error::input(
                "surface error",
                format!(
                    "{:e} mm, which takes more than {MAX_SPHERES} spheres for part {}",
                    1e3 * tolerance,
                    index + 1
                ),
                "a larger surface error",
            ));
        };
        kept.extend(
            spheres
                .into_iter()
                .filter(|s| !is_buried(s, index, solid, fit)),
        );
    }
    Ok(SphereUnion::new(kept)?.representing(Represented::Solid(solid.clone())))
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

/// Returns spheres that approximate a solid from which shapes are subtracted.
fn pack_less(solid: &Solid, tolerance: f64, fit: Fit) -> Result<SphereUnion> {
    match pack_difference(solid, fit) {
        Some(spheres) => {
            Ok(SphereUnion::new(spheres)?.representing(Represented::Solid(solid.clone())))
        }
        None => Err(Error::input(
            "surface error",
            format!(
                "{:e} mm, which takes more than {MAX_SPHERES} spheres for a solid less other shapes, or walls too thin for it",
                1e3 * tolerance
            ),
            "a larger surface error, or subtracted shapes that leave thicker walls",
        )),
    }
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
