//! Packings (spheres that represent meshes within a tolerance), stored in a cache folder next to the results. Each is a CSV file, named after the hash of its
//! inputs.
//!
//! The last line of a file is a seal of 80 bytes: `# bubbletouch <method>, crc32 <of all bytes before the line>`. If a file is truncated, changed or of another
//! version, the mesh is packed again, and a note is printed on standard error.

use crate::error::{Error, Result};
use crate::files::write_bytes;
use crate::inputs::content_hash::{bytes_of_mesh, bytes_of_numbers, sha256};
use crate::mesh::{LengthUnit, SizeLimits, Surface, TriangleMesh};
use crate::note::note;
use crate::objects::{Represented, SphereUnion, read_spheres, write_spheres};
use crate::packing::{Body, Packing, error_of_file, pack_mesh, slow_packing};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Version of the packing method, which changes whenever [`pack_mesh`] returns different spheres for a mesh.
const METHOD: &str = "packing 4";

/// Length of the last line of a packing file, bytes, including the line break; the line contains the checksum of the file.
const SEAL: usize = 80;

/// Spheres that approximate a mesh, and whether they come from the cache.
#[derive(Clone, Debug, PartialEq)]
pub struct Packed {
    /// Spheres that together approximate the mesh.
    pub spheres: SphereUnion,
    /// Whether the spheres were read from the cache folder.
    pub cached: bool,
}

/// Approximates a closed mesh by spheres within `tolerance` (metres), or reads cached spheres from `folder`. The folder is created if it is missing; without a
/// folder, nothing is cached.
///
/// # Errors
/// If the mesh cannot be packed, or the folder cannot be written; the error begins with `place`.
pub fn pack_within(
    place: &str,
    surface: &Surface,
    tolerance: f64,
    folder: Option<&Path>,
) -> Result<Packed> {
    pack_with(surface, (Body::Solid, tolerance), folder, || {
        if let Some(slow) = slow_packing(surface, Body::Solid, tolerance) {
            note(format_args!("{place}: {slow}"));
        }
        pack_mesh(surface, Body::Solid, tolerance).map_err(|error| {
            let advice = "a study closes small holes with objects.close_holes_mm; open meshes can be touched with model = \"mesh\", or with model = \"vertex_spheres\" beside other objects in a scene with a free object";
            error_of_file(error, place, advice)
        })
    })
}

/// Reads the cached spheres of a body within a tolerance (metres) from `folder`. If there are none, packs the body by calling `pack`, and writes the spheres.
///
/// Each file is written under another name and renamed, so that several processes can use one folder.
///
/// # Errors
/// If `pack` fails, or the folder cannot be written.
pub fn pack_with(
    surface: &Surface,
    (body, tolerance): (Body, f64),
    folder: Option<&Path>,
    pack: impl FnOnce() -> Result<Packing>,
) -> Result<Packed> {
    let path = folder.map(|folder| path_of(folder, surface.mesh(), (body, tolerance)));
    let represent = |spheres: SphereUnion| match body {
        Body::Solid => spheres.representing(Represented::Mesh(surface.mesh().clone())),
        Body::Sheet => spheres,
    };
    if let Some(spheres) = path.as_deref().map(read_packing).transpose()?.flatten() {
        return Ok(Packed {
            spheres: represent(spheres),
            cached: true,
        });
    }
    let packing = pack()?;
    if let (Some(folder), Some(path)) = (folder, path) {
        let mut bytes = Vec::new();
        write_spheres(&packing.spheres, &mut bytes).expect("memory takes all");
        bytes.extend(seal(&bytes).into_bytes());
        fs::create_dir_all(folder).map_err(|e| Error::io(folder, "create folder", e))?;
        write_bytes(&path, &bytes)?;
    }
    Ok(Packed {
        spheres: represent(packing.spheres),
        cached: false,
    })
}

/// Returns the path of the cache file with the spheres of a mesh for a tolerance in metres.
pub fn packing_path(folder: &Path, mesh: &TriangleMesh, tolerance: f64) -> PathBuf {
    path_of(folder, mesh, (Body::Solid, tolerance))
}

fn path_of(folder: &Path, mesh: &TriangleMesh, (body, tolerance): (Body, f64)) -> PathBuf {
    let made_from = [
        format!("{METHOD}{body:?}").into_bytes(),
        bytes_of_numbers([tolerance]),
        bytes_of_mesh(mesh),
    ];
    folder.join(format!("{}.csv", sha256(made_from.concat())))
}

/// Reads the spheres of a cache file; returns `None` if there is no complete file.
fn read_packing(path: &Path) -> Result<Option<SphereUnion>> {
    match fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        // Opening a pipe would block until another process writes to it.
        Ok(meta) if !meta.is_file() => {
            let allowed = "a folder of packings alone";
            return Err(Error::input(path.display(), "not a file", allowed));
        }
        _ => {}
    }
    let bytes = fs::read(path).map_err(|e| Error::io(path, "read", e))?;
    let (rows, said) = bytes.split_at(bytes.len().saturating_sub(SEAL));
    let spheres = read_spheres(
        &path.display().to_string(),
        Some(LengthUnit::Metre),
        &SizeLimits::ANY,
        rows,
    );
    match spheres {
        Ok(spheres) if said == seal(rows).as_bytes() => Ok(Some(spheres)),
        _ => {
            note(format_args!(
                "{} is damaged, or of another version: it is made again",
                path.display()
            ));
            Ok(None)
        }
    }
}

fn seal(rows: &[u8]) -> String {
    let crc = crc32fast::hash(rows);
    let said = format!("# bubbletouch {METHOD}, crc32 {crc:08x}");
    format!("{said:<width$}\n", width = SEAL - 1)
}
