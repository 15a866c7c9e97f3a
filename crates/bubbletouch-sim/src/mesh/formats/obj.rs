//! Meshes from Wavefront OBJ files, and their groups. Materials, normals and texture are ignored.

use super::joined_parts::used_positions;
use super::text_lines::{coordinates, each_line};
use crate::error::{Error, Result};
use crate::mesh::MeshFile;
use crate::text::spelling::nearest_names;
use glam::DVec3;
use std::collections::BTreeMap;
use std::io::BufRead;

/// Reads the mesh in an OBJ file; all objects and groups of the file form one mesh.
///
/// Only vertices that faces use are returned, in the order of their first use.
///
/// # Errors
/// If the file has no faces, a face has fewer than three corners, a coordinate is not finite, or a vertex index is out of range. The error begins with
/// `place` and the line.
pub fn read_obj(place: &str, source: impl BufRead) -> Result<MeshFile> {
    let mut vertices: Vec<DVec3> = Vec::new();
    // Corners of each face with the line of the face; indices count from 1. A face may precede its vertices.
    let mut faces: Vec<(usize, Vec<usize>)> = Vec::new();
    each_line(place, source, |number, line| {
        let line = line.split('#').next().unwrap_or_default();
        let mut words = line.split_whitespace();
        let at = || format!("{place}, line {number}");
        match words.next() {
            Some("v") => vertices.push(coordinates(at(), words)?),
            Some("f") => {
                let corners =
                    words.map(|word| index(word, vertices.len()).map_err(|e| e.under(at())));
                let corners = corners.collect::<Result<Vec<_>>>()?;
                if corners.len() < 3 {
                    let given = format!("a face with {} corners", corners.len());
                    return Err(Error::input(at(), given, "three corners or more"));
                }
                faces.push((number, corners));
            }
            _ => {}
        }
        Ok(())
    })?;
    if faces.is_empty() {
        let allowed = "an OBJ file with lines `v 0 0 1` and `f 1 2 3`";
        return Err(Error::input(place, "no faces", allowed));
    }
    let n = vertices.len();
    let mut polygons = Vec::with_capacity(faces.len());
    for (number, corners) in faces {
        if let Some(corner) = corners.iter().find(|&&corner| corner > n) {
            let place = format!("{place}, line {number}");
            let allowed = format!("1 to {n}, the number of vertices");
            return Err(Error::input(
                place,
                format!("vertex index {corner}"),
                allowed,
            ));
        }
        polygons.push(corners.iter().map(|corner| *corner as u32 - 1).collect());
    }
    let vertices = used_positions(&vertices, &mut polygons);
    MeshFile::new(place, vertices, polygons)
}

/// Returns the vertex index in the word of a face corner: `v`, `v/vt`, `v//vn` or `v/vt/vn`, counted from 1. Negative indices count back from the last of the
/// `n_vertices` vertices read so far.
fn index(word: &str, n_vertices: usize) -> Result<usize> {
    let vertex = word.split('/').next().unwrap_or_default();
    let index = match vertex.parse::<i64>() {
        Ok(index) if index > 0 => usize::try_from(index).ok(),
        Ok(index) if index < 0 => usize::try_from(index.unsigned_abs())
            .ok()
            .and_then(|back| (n_vertices + 1).checked_sub(back))
            .filter(|&index| index > 0),
        _ => None,
    };
    index.ok_or_else(|| {
        let allowed = format!("1 to the number of vertices, or -{n_vertices} to -1 here");
        Error::input("", format!("vertex index `{vertex}`"), allowed)
    })
}

/// Returns the indices of the triangles of a group (`g`) or object (`o`) in an OBJ file. The indices refer to the mesh that `read_obj` and
/// `into_mesh` create. A face belongs to the most recent groups and the most recent object before it.
///
/// # Errors
/// If the file cannot be read, or has no face in a group or object with this name.
pub fn obj_group(place: &str, source: impl BufRead, name: &str) -> Result<Vec<usize>> {
    let mut names: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    let (mut groups, mut object): (Vec<String>, Option<String>) = (Vec::new(), None);
    let mut n_triangles = 0;
    each_line(place, source, |_, line| {
        let line = line.split('#').next().unwrap_or_default();
        let mut words = line.split_whitespace();
        match words.next() {
            Some("g") => groups = words.map(str::to_owned).collect(),
            // A name may contain spaces.
            Some("o") => object = Some(words.collect::<Vec<_>>().join(" ")),
            Some("f") => {
                let n = words.count().saturating_sub(2);
                for name in groups.iter().chain(&object) {
                    let triangles = names.entry(name.clone()).or_default();
                    triangles.extend(n_triangles..n_triangles + n);
                }
                n_triangles += n;
            }
            _ => {}
        }
        Ok(())
    })?;
    if let Some(mut triangles) = names.remove(name) {
        triangles.dedup();
        return Ok(triangles);
    }
    let allowed = match names.is_empty() {
        true => "a name after `g` or `o`, of which the file has none".to_owned(),
        false => nearest_names(name, names.keys().map(String::as_str)),
    };
    Err(Error::input(place, format!("group `{name}`"), allowed))
}
