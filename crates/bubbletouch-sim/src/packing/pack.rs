//! Packing of a mesh with spheres.

use super::cover_surface::cover_surface;
use super::sampling::estimated_spheres;
use super::target::{Body, MESH, Target};
use crate::error::{Error, Result};
use crate::mesh::Surface;
use crate::objects::{MAX_SPHERES, SphereUnion};

/// Spheres that approximate a mesh, with the tolerance that has been proved for them.
#[derive(Clone, Debug, PartialEq)]
pub struct Packing {
    /// Spheres, in the frame of the mesh.
    pub spheres: SphereUnion,
    /// Proved maximum distance between the surfaces of the mesh and the spheres, metres.
    pub tolerance: f64,
}

/// Approximates the solid of a mesh by few spheres, within `tolerance` (metres, positive).
///
/// The tolerance is proved, as [the module](super#the-promise) describes. No sphere protrudes from the solid by more than half the tolerance. Every point of
/// the solid's surface is within the tolerance of the spheres. Equal meshes give equal spheres.
///
/// # Errors
/// - If the tolerance is not positive, or is so small that more than two million spheres are needed.
/// - If a [`Body::Solid`] has holes, has inconsistently oriented faces, or is inside out.
/// - If the surface cannot be proved to be within the tolerance, because its features are near the limits of floating-point numbers.
pub fn pack_mesh(surface: &Surface, body: Body, tolerance: f64) -> Result<Packing> {
    pack_mesh_watched(surface, body, tolerance, &mut |_| {})
}

/// Packs a mesh with few spheres, as [`pack_mesh`] does, and calls `watch` with the approximate completed fraction of the work, 0 to 1.
///
/// # Errors
/// If [`pack_mesh`] fails.
pub fn pack_mesh_watched(
    surface: &Surface,
    body: Body,
    tolerance: f64,
    watch: &mut dyn FnMut(f64),
) -> Result<Packing> {
    let target = Target::new(surface, body, tolerance)?;
    let (balls, n_unproved) = cover_surface(&target, watch)?;
    if n_unproved > 0 {
        let given = format!(
            "{n_unproved} places that are not proved to be within {} mm of the spheres",
            1e3 * tolerance
        );
        return Err(Error::input(MESH, given, "a larger tolerance"));
    }
    let spheres = balls.iter().map(|ball| ball.sphere(target.e)).collect();
    Ok(Packing {
        spheres: SphereUnion::new(spheres)?,
        tolerance,
    })
}

/// Minimum number of spheres for which [`slow_packing`] announces a long packing. Packings of this size take about half a minute on one processor. If larger,
/// long packings start without a notice; if smaller, packings of a few seconds are announced.
const MANY_SPHERES: f64 = 5_000.0;

/// Approximate computing time of a packing per sphere on one processor, milliseconds: 13 s for 2201 spheres of a scan.
const MS_A_SPHERE: f64 = 6.0;

/// Returns a message about the expected computing time of a packing if it is likely to take minutes; `None` otherwise.
pub fn slow_packing(surface: &Surface, body: Body, tolerance: f64) -> Option<String> {
    let target = Target::new(surface, body, tolerance).ok()?;
    let n_spheres = estimated_spheres(&target);
    let is_slow = (MANY_SPHERES..=MAX_SPHERES as f64).contains(&n_spheres);
    is_slow.then(|| {
        let minutes = (n_spheres * MS_A_SPHERE / 60e3).ceil();
        format!(
            "a surface error of {:e} mm takes about {n_spheres:.0} spheres and {minutes} min of one processor to pack",
            1e3 * tolerance
        )
    })
}

/// Adds the name of the mesh file and `advice` to an error of [`pack_mesh`] about the mesh. Other errors are returned unchanged.
pub fn error_of_file(error: Error, file: &str, advice: &str) -> Error {
    match error {
        Error::Input {
            place,
            given,
            allowed,
        } if place == MESH => Error::input(file, given, format!("{allowed} ({advice})")),
        other => other,
    }
}
