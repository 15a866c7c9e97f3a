//! Meshes as spheres within a tolerance, kept in a folder beside the results.

use super::packing_cache::{CachedPacking, PackingCache};
use crate::error::{Error, Result};
use crate::mesh::Surface;
use crate::objects::SphereUnion;
use crate::packing::{Body, error_of_file, pack_mesh};
use std::path::Path;

/// Spheres that stand for a mesh, and where they are from.
pub(crate) struct Packed {
    pub spheres: SphereUnion,
    /// Whether they were in the folder already.
    pub was_kept: bool,
}

/// Packs a closed mesh within `tolerance` (metres), or finds what was packed before in `folder` (made if it is missing;
/// nothing is kept without one).
///
/// The error begins with `place` and says what the mesh lacks.
pub(crate) fn pack_within(
    place: &str,
    surface: &Surface,
    tolerance: f64,
    folder: Option<&Path>,
) -> Result<Packed> {
    let cached = match folder {
        None => pack_mesh(surface, Body::Solid, tolerance).map(|packing| CachedPacking {
            packing,
            was_kept: false,
        }),
        Some(folder) => {
            std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, "create folder", e))?;
            PackingCache::new(folder).pack_mesh(surface, Body::Solid, tolerance, &mut |_| {})
        }
    };
    let CachedPacking { packing, was_kept } = cached.map_err(|error| {
        let advice = "a study closes small holes with objects.close_holes_mm; open meshes can be touched with model = \"mesh\"";
        error_of_file(error, place, advice)
    })?;
    Ok(Packed {
        spheres: packing.spheres,
        was_kept,
    })
}
