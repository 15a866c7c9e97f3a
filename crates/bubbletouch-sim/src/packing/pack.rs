//! From a mesh to the spheres that stand for it.

use super::cover_surface::cover_surface;
use super::sampling::estimated_spheres;
use super::target::{Body, MESH, Target};
use crate::error::{Error, Result};
use crate::mesh::Surface;
use crate::objects::{MAX_SPHERES, SphereUnion};

/// Spheres that stand for a mesh, and what is proved of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Packing {
    /// In the mesh's frame.
    pub spheres: SphereUnion,
    /// How far the two surfaces may be apart, metres.
    pub tolerance: f64,
}

/// Packs a mesh with few spheres within `tolerance` (metres, positive) of the solid that it stands for.
///
/// Proved, as [the module](super#the-promise) says: no sphere reaches more than half the tolerance outside the solid, and every
/// point of its surface is within the tolerance of the spheres. The same mesh gives the same spheres.
///
/// # Errors
/// A tolerance that is not positive, or so small that it takes more than two million spheres; a [`Body::Solid`] with holes,
/// with faces that disagree about the outside, or inside out; a surface that cannot be proved to be within the tolerance, for
/// its features are near the limits of floating-point numbers.
pub fn pack_mesh(surface: &Surface, body: Body, tolerance: f64) -> Result<Packing> {
    pack_mesh_watched(surface, body, tolerance, &mut |_| {})
}

/// [`pack_mesh`] that says now and then which share of its work is done, about, from 0 to 1.
///
/// # Errors
/// Those of [`pack_mesh`].
pub fn pack_mesh_watched(
    surface: &Surface,
    body: Body,
    tolerance: f64,
    watch: &mut dyn FnMut(f64),
) -> Result<Packing> {
    let target = Target::new(surface, body, tolerance)?;
    let (balls, n_unproved) = cover_surface(&target, watch)?;
    if n_unproved > 0 {
        return Err(Error::input(
            MESH,
            format!(
                "{n_unproved} places that are not proved to be within {} mm of the spheres",
                1e3 * tolerance
            ),
            "a larger tolerance",
        ));
    }
    let spheres = balls.iter().map(|ball| ball.sphere(target.e)).collect();
    Ok(Packing {
        spheres: SphereUnion::new(spheres)?,
        tolerance,
    })
}

/// Number of spheres from which on [`slow_packing`] returns a sentence: about half a minute of one processor. Larger: long packings begin without a word;
/// smaller: packings of seconds are announced.
const MANY_SPHERES: f64 = 5_000.0;

/// Milliseconds of one processor for each sphere of a packing, about: 13 s for 2201 spheres of a scan.
const MS_A_SPHERE: f64 = 6.0;

/// Returns a sentence about the expected time of a packing if it is likely to take minutes, before it begins.
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

/// An error of [`pack_mesh`] about the mesh itself, under the name of its file, and with what else may be done; another error
/// as it is.
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
