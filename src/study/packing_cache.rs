//! Packings kept in a folder, by what they were made from.

use super::content_hash::ContentHash;
use super::sealed::{self, SealedFile, Unsealed};
use crate::error::Result;
use crate::mesh::{Surface, TriangleMesh};
use crate::objects::{SphereUnion, read_spheres, write_spheres};
use crate::packing::{Body, Packing, pack_mesh_watched};
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

/// Changes whenever [`pack_mesh`](crate::packing::pack_mesh) gives other spheres for the same mesh.
const METHOD: &str = "packing 4";

/// A folder of packings, one CSV file each (and its seal), named by the SHA-256 of mesh, body, tolerance and method.
#[derive(Clone, Debug)]
pub struct PackingCache {
    folder: PathBuf,
}

/// A packing that a cache gave.
#[derive(Clone, Debug, PartialEq)]
pub struct CachedPacking {
    /// The spheres.
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
    /// A kept file that is cut, changed or not readable is packed again, and so said on standard error.
    ///
    /// # Errors
    /// As of [`pack_mesh`](crate::packing::pack_mesh), and a folder that cannot be written.
    pub fn pack_mesh(
        &self,
        surface: &Surface,
        body: Body,
        tolerance: f64,
        watch: &mut dyn FnMut(f64),
    ) -> Result<CachedPacking> {
        let path = self.path(surface.mesh(), body, tolerance);
        if let Some(spheres) = kept(&path)? {
            return Ok(CachedPacking {
                packing: Packing { spheres, tolerance },
                was_kept: true,
            });
        }
        let packing = pack_mesh_watched(surface, body, tolerance, watch)?;
        keep(&path, &packing.spheres)?;
        Ok(CachedPacking {
            packing,
            was_kept: false,
        })
    }
}

/// The spheres of a whole file.
fn kept(path: &Path) -> Result<Option<SphereUnion>> {
    let Some(Unsealed { file, n_bytes }) = sealed::open(path, METHOD)? else {
        return Ok(None);
    };
    let place = path.display().to_string();
    match read_spheres(&place, BufReader::new(file.take(n_bytes))) {
        Ok(spheres) => Ok(Some(spheres)),
        Err(error) => {
            sealed::make_again(path, &format!("not readable ({error})"))?;
            Ok(None)
        }
    }
}

fn keep(path: &Path, spheres: &SphereUnion) -> Result<()> {
    let mut bytes = Vec::new();
    write_spheres(spheres, &mut bytes).expect("memory takes all");
    let mut file = SealedFile::create(path, METHOD)?;
    file.write(&bytes)?;
    file.commit()
}

fn key(mesh: &TriangleMesh, body: Body, tolerance: f64) -> String {
    ContentHash::default()
        .bytes(METHOD)
        .bytes(format!("{body:?}"))
        .numbers([tolerance])
        .mesh(mesh)
        .hex()
}
