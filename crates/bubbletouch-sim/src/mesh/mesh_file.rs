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
    /// Checks the invariant; vertices are metres.
    ///
    /// # Errors
    /// Where it does not hold; errors begin with `place` and count from 1.
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

    /// Every coordinate times a factor.
    pub(super) fn scaled(self, place: &str, factor: f64) -> Result<Self> {
        let vertices = self.vertices.into_iter().map(|v| v * factor).collect();
        Self::new(place, vertices, self.polygons)
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
    /// # Errors
    /// An error if there are no polygons, or if a fan would fold over itself: its polygon is not convex, or bent.
    pub fn into_mesh(self, place: &str) -> Result<TriangleMesh> {
        if let Some(index) = self.polygons.iter().position(|p| self.folds(p)) {
            return Err(Error::input(
                format!("{place}: face {}", index + 1),
                format!("{} corners that are not convex", self.polygons[index].len()),
                "convex faces, or triangles",
            ));
        }
        let fan = |corners: &Vec<u32>| {
            let first = corners[0];
            let rest = corners[1..].windows(2);
            rest.map(|pair| [first, pair[0], pair[1]])
                .collect::<Vec<_>>()
        };
        let triangles = self.polygons.iter().flat_map(fan).collect();
        TriangleMesh::new(place, self.vertices, triangles)
    }

    /// Whether a triangle of the fan lies upside down in its polygon, judged by the area vector of the whole.
    fn folds(&self, polygon: &[u32]) -> bool {
        if polygon.len() == 3 {
            return false;
        }
        let corner = |index: u32| self.vertices[index as usize];
        let first = corner(polygon[0]);
        let parts = polygon[1..].windows(2);
        let areas = parts.map(|pair| (corner(pair[0]) - first).cross(corner(pair[1]) - first));
        let whole: DVec3 = areas.clone().sum();
        // A corner on the line between its neighbours, give or take rounding, is no fold.
        let rounding = 1e-9 * whole.length_squared();
        areas.into_iter().any(|area| area.dot(whole) < -rounding)
    }
}
