//! From a mesh to the spheres that stand for it.

use super::cover_surface::cover_surface;
use super::target::{Body, Target};
use crate::error::Result;
use crate::mesh::Surface;
use crate::objects::SphereUnion;

/// Spheres that stand for a mesh, and what is proved of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Packing {
    /// In the mesh's frame.
    pub spheres: SphereUnion,
    /// How far the two surfaces may be apart, metres.
    pub tolerance: f64,
    /// Places of the outer surface that are not proved to be within the tolerance of the spheres; 0 but for meshes with
    /// features near the limits of floating-point numbers.
    pub n_unproved: usize,
}

/// Packs a mesh with few spheres whose surface is within `tolerance` (metres, positive) of the mesh's outer surface.
///
/// No sphere reaches more than half the tolerance outside the mesh, and every point of the outer surface is within the
/// tolerance of the spheres; faces that lie inside other parts of the mesh are not outer surface. The same mesh gives the
/// same spheres. An error for a tolerance that is not positive, or so small that it takes more than
/// two million spheres, and for a [`Body::Solid`] with holes, with faces that
/// disagree about the outside, or inside out.
pub fn pack_mesh(surface: &Surface, body: Body, tolerance: f64) -> Result<Packing> {
    pack_mesh_watched(surface, body, tolerance, &mut |_| {})
}

/// [`pack_mesh`] that says now and then which share of its work is done, about, from 0 to 1.
pub fn pack_mesh_watched(
    surface: &Surface,
    body: Body,
    tolerance: f64,
    watch: &mut dyn FnMut(f64),
) -> Result<Packing> {
    let target = Target::new(surface, body, tolerance)?;
    let (balls, n_unproved) = cover_surface(&target, watch)?;
    let spheres = balls.iter().map(|ball| ball.sphere(target.e)).collect();
    Ok(Packing {
        spheres: SphereUnion::new(spheres)?,
        tolerance,
        n_unproved,
    })
}
