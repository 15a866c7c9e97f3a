//! Meshes from Wavefront OBJ files: positions and faces; groups, materials, normals and texture are left out.

use super::MeshFile;
use crate::error::{Error, Result};
use glam::DVec3;
use std::io::{BufRead, Cursor};
use tobj::{LoadError, LoadOptions};

/// A mesh from an OBJ file's content.
///
/// Only vertices that a face has are kept.
///
/// # Errors
/// A file without faces, a number that is none, or an index of no vertex.
pub fn read_obj(place: &str, source: impl BufRead) -> Result<MeshFile> {
    let shape = positions_and_faces(place, source)?;
    let options = LoadOptions {
        ignore_points: true,
        ignore_lines: true,
        ..LoadOptions::default()
    };
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(shape), &options, |_| {
        Err(LoadError::GenericFailure)
    })
    .map_err(|e| {
        Error::input(
            place,
            format!("not readable as OBJ: {e}"),
            "lines such as `v 0 0 1` and `f 1 2 3`",
        )
    })?;
    let mut meshes = models.into_iter().map(|model| model.mesh);
    let Some(mesh) = meshes.find(|mesh| !mesh.indices.is_empty()) else {
        return Err(Error::input(
            place,
            "no faces",
            "an OBJ file with lines `f 1 2 3`",
        ));
    };
    let vertices = mesh.positions.chunks_exact(3).map(DVec3::from_slice);
    // No arities: triangles only.
    let polygons = if mesh.face_arities.is_empty() {
        mesh.indices.chunks(3).map(<[u32]>::to_vec).collect()
    } else {
        let mut left = &mesh.indices[..];
        let arities = mesh.face_arities.iter();
        arities
            .map(|&arity| {
                let (polygon, rest) = left.split_at(left.len().min(arity as usize));
                left = rest;
                polygon.to_vec()
            })
            .collect()
    };
    MeshFile::new(place, vertices.collect(), polygons)
}

/// The lines that begin with `v` and `f`, positions only: one model without groups, materials or seams.
fn positions_and_faces(place: &str, source: impl BufRead) -> Result<Vec<u8>> {
    let mut text = String::new();
    for line in source.lines() {
        let line = line.map_err(|e| match e.kind() {
            std::io::ErrorKind::InvalidData => {
                Error::input(place, "not readable as OBJ: not text", "a text file")
            }
            _ => Error::io(place, "read", e),
        })?;
        let mut words = line.split_whitespace();
        let Some(kind @ ("v" | "f")) = words.next() else {
            continue;
        };
        text.push_str(kind);
        // x, y, z and no weight or colour.
        for word in words.take(if kind == "v" { 3 } else { usize::MAX }) {
            text.push(' ');
            text.push_str(if kind == "f" {
                word.split('/').next().unwrap_or(word)
            } else {
                word
            });
        }
        text.push('\n');
    }
    Ok(text.into_bytes())
}
