//! Packings kept in a folder, by what they were made from.

use super::content_hash::ContentHash;
use crate::error::{Error, Result};
use crate::files::write_whole;
use crate::mesh::{Surface, TriangleMesh};
use crate::objects::{read_spheres, write_spheres};
use crate::packing::{Body, Packing, pack_mesh_watched};
use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;

/// Changes whenever [`pack_mesh`](crate::packing::pack_mesh) gives other spheres for the same mesh.
const METHOD: &str = "packing 3";

/// A folder of packings, one CSV file each, named by the SHA-256 of mesh, body, tolerance and method.
#[derive(Clone, Debug)]
pub struct PackingCache {
    folder: PathBuf,
}

/// A packing that a cache gave.
#[derive(Clone, Debug, PartialEq)]
pub struct CachedPacking {
    /// All of it proved, if it was kept.
    pub packing: Packing,
    /// Whether it was in the cache before.
    pub was_kept: bool,
}

impl PackingCache {
    /// A cache in a folder that exists, beside the results.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self {
            folder: folder.into(),
        }
    }

    /// Where the packing of a mesh is kept.
    pub fn path(&self, mesh: &TriangleMesh, body: Body, tolerance: f64) -> PathBuf {
        self.folder
            .join(format!("{}.csv", key(mesh, body, tolerance)))
    }

    /// [`pack_mesh`](crate::packing::pack_mesh), or what it gave before for the same mesh. `watch` is told now and then which
    /// share of the work is done, about, from 0 to 1.
    ///
    /// A packing is kept if all of it is proved. Errors also for a kept file that cannot be read, and a folder that cannot
    /// be written.
    pub fn pack_mesh(
        &self,
        surface: &Surface,
        body: Body,
        tolerance: f64,
        watch: &mut dyn FnMut(f64),
    ) -> Result<CachedPacking> {
        let path = self.path(surface.mesh(), body, tolerance);
        match File::open(&path) {
            Ok(file) => {
                let place = path.display().to_string();
                let packing = Packing {
                    spheres: read_spheres(&place, BufReader::new(file))?,
                    tolerance,
                    n_unproved: 0,
                };
                return Ok(CachedPacking {
                    packing,
                    was_kept: true,
                });
            }
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                return Err(Error::io(&path, "read", error));
            }
            Err(_) => {}
        }
        let packing = pack_mesh_watched(surface, body, tolerance, watch)?;
        if packing.n_unproved == 0 {
            write_whole(&path, |sink| write_spheres(&packing.spheres, sink))?;
        }
        Ok(CachedPacking {
            packing,
            was_kept: false,
        })
    }
}

fn key(mesh: &TriangleMesh, body: Body, tolerance: f64) -> String {
    ContentHash::default()
        .bytes(METHOD)
        .bytes(format!("{body:?}"))
        .numbers([tolerance])
        .mesh(mesh)
        .hex()
}
