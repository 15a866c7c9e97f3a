//! Contents of a mesh file, before conversion to a triangle mesh.

use super::triangle_mesh::{check_indices, check_vertices};
use super::{LengthUnit, TriangleMesh};
use crate::error::{Error, Result};
use glam::DVec3;

/// Vertices and polygons of a mesh file. A file without polygons is a point cloud, which suffices for spheres around vertices.
///
/// Invariant: there is at least one vertex, and all are finite. Polygons have at least three corners, each index below the number of vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    vertices: Vec<DVec3>,
    polygons: Vec<Vec<u32>>,
}

impl MeshFile {
    /// Creates the contents of a mesh file and checks the invariant. Vertices are in metres.
    ///
    /// # Errors
    /// If the invariant does not hold; errors begin with `place` and count from 1.
    pub(in crate::mesh) fn new(
        place: &str,
        vertices: Vec<DVec3>,
        polygons: Vec<Vec<u32>>,
    ) -> Result<Self> {
        check_vertices(place, &vertices)?;
        if let Some(index) = polygons.iter().position(|corners| corners.len() < 3) {
            let given = format!("{} corners", polygons[index].len());
            let allowed = "at least three vertex indices, from 0";
            return Err(Error::input(
                format!("{place}: face {}", index + 1),
                given,
                allowed,
            ));
        }
        check_indices(place, &polygons, vertices.len())?;
        Ok(Self { vertices, polygons })
    }

    /// Returns the contents of the file with every coordinate multiplied by a factor.
    pub(in crate::mesh) fn scaled(self, place: &str, factor: f64) -> Result<Self> {
        if factor == 1.0 {
            return Ok(self);
        }
        let vertices = self.vertices.into_iter().map(|v| v * factor).collect();
        Self::new(place, vertices, self.polygons)
    }

    /// Returns the vertices of the file, metres.
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Returns the vertex indices of each polygon.
    pub fn polygons(&self) -> &[Vec<u32>] {
        &self.polygons
    }

    /// Converts the file to a triangle mesh. Polygons of more than three corners become fans around their first corner: 0 1 2, 0 2 3, 0 3 4, …
    ///
    /// # Errors
    /// If there are no polygons, or if a fan would overlap itself because its polygon is not convex or not planar.
    pub fn into_mesh(self, place: &str) -> Result<TriangleMesh> {
        if let Some(index) = self.polygons.iter().position(|p| self.folds(p)) {
            let given = format!("{} corners that are not convex", self.polygons[index].len());
            let place = format!("{place}: face {}", index + 1);
            return Err(Error::input(place, given, "convex faces, or triangles"));
        }
        let fan = |corners: &Vec<u32>| {
            let first = corners[0];
            let rest = corners[1..].windows(2);
            rest.map(|pair| [first, pair[0], pair[1]])
                .collect::<Vec<_>>()
        };
        let triangles = self.polygons.iter().flat_map(fan).collect();
        TriangleMesh::in_unit(place, LengthUnit::Metre, self.vertices, triangles)
    }

    /// Returns whether a triangle of the polygon's fan is reversed relative to the area vector of the polygon.
    fn folds(&self, polygon: &[u32]) -> bool {
        if polygon.len() == 3 {
            return false;
        }
        let corner = |index: u32| self.vertices[index as usize];
        let first = corner(polygon[0]);
        let parts = polygon[1..].windows(2);
        let areas = parts.map(|pair| (corner(pair[0]) - first).cross(corner(pair[1]) - first));
        let whole: DVec3 = areas.clone().sum();
        // A corner on the line between its neighbours, within rounding, is not reversed.
        let rounding = 1e-9 * whole.length_squared();
        areas.into_iter().any(|area| area.dot(whole) < -rounding)
    }
}
