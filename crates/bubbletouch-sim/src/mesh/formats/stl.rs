//! Meshes from STL files, ASCII or binary. Corners with identical coordinates become one vertex; normals are ignored.

use super::text_lines::{BYTE_ORDER_MARK, all_bytes, coordinates, each_line};
use crate::error::{Error, Result};
use crate::geometry::place_bits;
use crate::mesh::MeshFile;
use glam::DVec3;
use std::collections::HashMap;
use std::io::BufRead;

/// Number of bytes before the triangles of a binary file: a header of 80 bytes and the number of triangles.
const HEADER: usize = 84;
/// Number of bytes per triangle in a binary file: normal, three corners, two bytes of attributes.
const TRIANGLE: usize = 50;

/// Reads the mesh in an STL file; all solids of an ASCII file form one mesh.
///
/// # Errors
/// If the file is truncated or is not an STL file. The error begins with `place`.
pub fn read_stl(place: &str, source: impl BufRead) -> Result<MeshFile> {
    let content = all_bytes(place, source)?;
    // The length decides, because some programs begin a binary header with the first word of an ASCII file.
    if is_binary(&content) {
        return merged(place, &binary_corners(&content));
    }
    let text = content.strip_prefix(&BYTE_ORDER_MARK).unwrap_or(&content);
    let text = text.trim_ascii_start();
    if text.len() >= 5 && text[..5].eq_ignore_ascii_case(b"solid") {
        return merged(place, &ascii_corners(place, &content)?);
    }
    let given = match content.len() {
        0 => "an empty file",
        n if n < HEADER => "not an STL file",
        _ => "not an STL file, or cut off",
    };
    Err(Error::input(
        place,
        given,
        "a text that begins with `solid`, or 84 bytes and 50 for each triangle",
    ))
}

/// Returns whether the content is a binary STL file: its length equals the length that its number of triangles requires.
fn is_binary(content: &[u8]) -> bool {
    let Some(&[a, b, c, d]) = content.get(80..HEADER) else {
        return false;
    };
    let n_triangles = u32::from_le_bytes([a, b, c, d]) as usize;
    content.len() - HEADER == n_triangles.saturating_mul(TRIANGLE)
}

/// Returns the corners of the triangles in a binary STL file, three per triangle.
fn binary_corners(content: &[u8]) -> Vec<DVec3> {
    let triangles = content[HEADER..].chunks_exact(TRIANGLE);
    let corners = triangles.flat_map(|triangle| triangle[12..48].chunks_exact(12));
    let number =
        |bytes: &[u8]| f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
    let point = |corner: &[u8]| [0, 4, 8].map(|at| number(&corner[at..]));
    corners.map(|corner| point(corner).into()).collect()
}

/// State of the reader of an ASCII file.
#[derive(Clone, Copy, PartialEq)]
enum State {
    /// Between two solids.
    Outside,
    /// In a solid, between two facets.
    Solid,
    /// In a facet, after this number of corners.
    Facet(usize),
}

/// Returns the corners of the facets in an ASCII STL file with any number of solids, three per facet. Keywords may be in upper case.
fn ascii_corners(place: &str, content: &[u8]) -> Result<Vec<DVec3>> {
    let mut corners = Vec::new();
    let mut state = State::Outside;
    each_line(place, content, |number, line| {
        let mut words = line.split_whitespace();
        let Some(word) = words.next() else {
            return Ok(());
        };
        let at = format!("{place}, line {number}");
        state = match (word.to_ascii_lowercase().as_str(), state) {
            ("solid", State::Outside | State::Solid) => State::Solid,
            ("endsolid", State::Solid) => State::Outside,
            ("facet", State::Solid) => State::Facet(0),
            ("vertex", State::Facet(n)) if n < 3 => {
                corners.push(coordinates(at, words)?);
                State::Facet(n + 1)
            }
            ("endfacet", State::Facet(3)) => State::Solid,
            ("outer" | "endloop", State::Facet(_)) => state,
            (word_in_lower_case, _) => {
                let allowed = match (word_in_lower_case, state) {
                    ("vertex" | "endfacet", State::Facet(_)) => {
                        "exactly three vertices in each facet"
                    }
                    _ => "`solid`, facets of three vertices, and `endsolid`, in this order",
                };
                let given = format!("not readable as STL: `{word}` here");
                return Err(Error::input(at, given, allowed));
            }
        };
        Ok(())
    })?;
    if state == State::Outside {
        return Ok(corners);
    }
    let given = "cut off: a solid without its end";
    Err(Error::input(
        place,
        given,
        "facets and `endsolid` at the end",
    ))
}

/// Returns the mesh whose triangles have three consecutive `corners` each. Corners with identical coordinates become one vertex, in the order of first
/// occurrence.
fn merged(place: &str, corners: &[DVec3]) -> Result<MeshFile> {
    let (mut numbers, mut vertices) = (HashMap::new(), Vec::new());
    let number = |&corner: &DVec3| {
        *numbers.entry(place_bits(corner)).or_insert_with(|| {
            vertices.push(corner);
            vertices.len() as u32 - 1
        })
    };
    let indices: Vec<u32> = corners.iter().map(number).collect();
    MeshFile::new(
        place,
        vertices,
        indices.chunks(3).map(<[u32]>::to_vec).collect(),
    )
}
