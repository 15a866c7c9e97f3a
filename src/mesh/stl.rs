//! Meshes from STL files, ascii or binary. Corners at exactly the same place become one vertex; normals are left out.

use super::MeshFile;
use crate::error::{Error, Result};
use glam::DVec3;
use std::io::{BufRead, Cursor, ErrorKind};

/// What a binary file has before its triangles: 80 bytes of any content and their number.
const HEADER: usize = 84;
/// What a triangle takes in a binary file.
const TRIANGLE: usize = 50;

/// A mesh from an STL file's content; errors begin with `place`, the file's name.
///
/// # Errors
/// An error for a file that is cut off, or that is neither kind of STL.
pub fn read_stl(place: &str, mut source: impl BufRead) -> Result<MeshFile> {
    let mut content = Vec::new();
    source
        .read_to_end(&mut content)
        .map_err(|e| Error::io(place, "read", e))?;
    if is_binary(&content) {
        // Some programs begin a binary header with the word by which an ascii file is known.
        content[..80].fill(0);
    } else if !content.starts_with(b"solid") {
        let given = match content.len() {
            0 => "an empty file",
            n if n < HEADER => "not an STL file",
            _ => "not an STL file, or cut off",
        };
        return Err(Error::input(
            place,
            given,
            "a text that begins with `solid`, or 84 bytes and 50 for each triangle",
        ));
    } else {
        // The word may stand alone; the crate wants a space after it.
        content.insert(5, b' ');
    }
    let mesh = stl_io::read_stl(&mut Cursor::new(content)).map_err(|e| malformed(place, &e))?;
    let vertex = |v: &stl_io::Vertex| DVec3::from_array(v.0.map(f64::from));
    let vertices = mesh.vertices.iter().map(vertex).collect();
    let face = |f: &stl_io::IndexedTriangle| f.vertices.map(|corner| corner as u32).to_vec();
    MeshFile::new(place, vertices, mesh.faces.iter().map(face).collect())
}

/// Whether the content is exactly as long as its number of triangles says.
fn is_binary(content: &[u8]) -> bool {
    let Some(&[a, b, c, d]) = content.get(80..HEADER) else {
        return false;
    };
    let n_triangles = u32::from_le_bytes([a, b, c, d]) as usize;
    content.len() - HEADER == n_triangles.saturating_mul(TRIANGLE)
}

fn malformed(place: &str, error: &std::io::Error) -> Error {
    let text = error.to_string();
    let first = text.lines().next().unwrap_or_default();
    match error.kind() {
        ErrorKind::UnexpectedEof => Error::input(
            place,
            format!("cut off: {first}"),
            "facets and `endsolid` at the end",
        ),
        _ => Error::input(
            place,
            format!("not readable as STL: {first}"),
            "facets of three vertices with finite numbers",
        ),
    }
}
