//! What a mesh file says, before anybody asks for a surface.

use super::TriangleMesh;
use super::triangle_mesh::check_vertices;
use crate::error::{Error, Result};
use glam::DVec3;

/// Corners and polygons as written. A file without polygons is a point cloud, and enough for spheres around vertices.
///
/// Invariant: at least one vertex, all finite; three or more corners a polygon, each index below the number of vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    vertices: Vec<DVec3>,
    polygons: Vec<Vec<u32>>,
}

impl MeshFile {
    /// Checks the invariant. Errors begin with `place` and count from 1; vertices are metres.
    pub fn new(place: &str, vertices: Vec<DVec3>, polygons: Vec<Vec<u32>>) -> Result<Self> {
        check_vertices(place, &vertices)?;
        if let Some(index) = polygons.iter().position(|corners| corners.len() < 3) {
            return Err(Error::input(
                format!("{place}: face {}", index + 1),
                format!("{} corners", polygons[index].len()),
                "at least three vertex indices, from 0",
            ));
        }
        let n = vertices.len();
        let outside = |corners: &Vec<u32>| corners.iter().any(|&corner| corner as usize >= n);
        if let Some(index) = polygons.iter().position(outside) {
            return Err(Error::input(
                format!("{place}: face {}", index + 1),
                format!("vertex indices {:?}", polygons[index]),
                format!("0 to {}, the indices of the vertices", n - 1),
            ));
        }
        Ok(Self { vertices, polygons })
    }

    /// Corners, metres.
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Vertex indices of each polygon.
    pub fn polygons(&self) -> &[Vec<u32>] {
        &self.polygons
    }

    /// The surface; polygons of more than three corners are cut into a fan around their first: 0 1 2, 0 2 3, 0 3 4, …
    ///
    /// An error if there are no polygons.
    pub fn into_mesh(self, place: &str) -> Result<TriangleMesh> {
        let fan = |corners: &Vec<u32>| {
            let first = corners[0];
            let rest = corners[1..].windows(2);
            rest.map(|pair| [first, pair[0], pair[1]])
                .collect::<Vec<_>>()
        };
        let triangles = self.polygons.iter().flat_map(fan).collect();
        TriangleMesh::new(place, self.vertices, triangles)
    }
}
