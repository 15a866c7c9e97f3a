//! From a solid to the spheres that stand for it, with a stated surface error.
//!
//! Let e be the tolerance. Each sphere is the largest ball inside the solid that touches its surface at some point,
//! radius r, swollen by e/2: no point of it lies more than e/2 outside. Such a sphere comes within e of every surface point p
//! with |p − c| ≤ r + h, h = 3e/2; the feet are chosen so that these reaches cover the whole surface. On a flat face a ball
//! reaches sqrt(h(2r + h)) around its foot, so large balls are few; at a right-angled edge it must have r ≤ h/(√2 − 1) to
//! reach the edge. Each form has its own closed layout of feet (`block`, `lathe`, `sphere_sweep`, `torus`), or cells that are split
//! until they are covered (`prism`).
//!
//! Where shapes are subtracted, cells of all surfaces are split in that way (`difference`).
//!
//! With half of e outside, the spheres' bumps and hollows about cancel (`fit`): the mean of the spheres' surface is the
//! solid's, as it is for packed meshes ([`crate::packing`]). A ball is its own sphere, and so are the balls of a strand:
//! nothing of them is swollen.

use super::difference::pack_difference;
use super::fit::{Fit, MAX_SPHERES};
use super::{Solid, Sphere, SphereUnion};
use crate::error::{Error, Result};

/// Spheres whose union is the solid to within `tolerance` (metres, positive).
///
/// No sphere reaches more than half of `tolerance` outside the solid, and no point of the solid's outer surface lies more than `tolerance`
/// outside the spheres ([`surface_error`](super::surface_error) measures both); on average the two surfaces are equally high. A ball is one
/// sphere, its own. The same input gives the same spheres, in the order of the parts.
///
/// # Errors
/// A tolerance that is not positive, or so small that a part would need more than [`MAX_SPHERES`].
pub fn pack(solid: &Solid, tolerance: f64) -> Result<SphereUnion> {
    if !(tolerance.is_finite() && tolerance > 0.0) {
        return Err(Error::input(
            "surface error",
            format!("{tolerance} m"),
            "a finite positive length",
        ));
    }
    // Leaves rounding errors a place, so that what is promised is kept to the last digit.
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
    SphereUnion::new(kept)
}

impl Solid {
    /// Packs the solid, as [`pack`] does.
    ///
    /// # Errors
    /// Those of [`pack`].
    pub fn pack(&self, tolerance: f64) -> Result<SphereUnion> {
        pack(self, tolerance)
    }
}

/// A solid from which something is subtracted.
fn pack_less(solid: &Solid, tolerance: f64, fit: Fit) -> Result<SphereUnion> {
    match pack_difference(solid, fit) {
        Some(spheres) => SphereUnion::new(spheres),
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

/// Whether all surface that a sphere is there for lies inside another part.
///
/// It is there for surface points within what is covered of its centre: its radius and the gap that is allowed. Of two equal parts the later one is buried.
fn is_buried(sphere: &Sphere, part: usize, solid: &Solid, fit: Fit) -> bool {
    let others = solid.parts().iter().enumerate().filter(|&(i, _)| i != part);
    let reach = sphere.radius + fit.inside;
    others
        .map(|(_, other)| other.distance(sphere.center))
        .any(|distance| distance < -reach)
}
