//! A triangle mesh, as scanners and modellers write it.

use crate::error::{Error, Result};
use glam::DVec3;

/// Triangles over shared corners, in the object's frame. Nothing is said about holes or orientation.
///
/// Invariant: at least one vertex, all finite; each face index below the number of vertices. A mesh without faces is a
/// point cloud, and allowed.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    vertices: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
}

impl Mesh {
    /// Checks the invariant. Errors begin with `place` and count from 1; vertices are metres.
    pub fn new(place: &str, vertices: Vec<DVec3>, faces: Vec<[u32; 3]>) -> Result<Self> {
        if vertices.is_empty() {
            return Err(Error::input(place, "no vertices", "at least one vertex"));
        }
        if let Some(index) = vertices.iter().position(|v| !v.is_finite()) {
            return Err(Error::input(
                format!("{place}: vertex {}", index + 1),
                vertices[index],
                "finite coordinates",
            ));
        }
        let n = vertices.len();
        let outside = |face: &[u32; 3]| face.iter().any(|&corner| corner as usize >= n);
        if let Some(index) = faces.iter().position(outside) {
            return Err(Error::input(
                format!("{place}: face {}", index + 1),
                format!("vertex indices {:?}", faces[index]),
                format!("0 to {}, the indices of the vertices", n - 1),
            ));
        }
        Ok(Self { vertices, faces })
    }

    /// Corners, metres.
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Three vertex indices a triangle.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }
}
