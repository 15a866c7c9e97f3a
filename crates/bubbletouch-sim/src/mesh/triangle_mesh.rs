//! Triangle meshes, as scanners and modelling programs produce them.

use super::{LengthUnit, SizeLimits, Triangle};
use crate::error::{Error, Result};
use crate::geometry::{Aabb, Pose};
use glam::DVec3;

/// Triangle mesh with shared corners, in the frame of the object. The mesh may have holes and any orientation.
///
/// Invariant: there is at least one triangle, every vertex is finite, and every index is below the number of vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleMesh {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// Creates a triangle mesh from vertices in metres, and checks the invariant and the size.
    ///
    /// # Errors
    /// If the invariant does not hold, or the size is not within [`SizeLimits::ANY`]: numbers in millimetres need [`in_unit`](Self::in_unit). Errors begin with
    /// `place` and count from 1.
    pub fn new(place: &str, vertices: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<Self> {
        let mesh = Self::in_unit(place, LengthUnit::Metre, vertices, triangles)?;
        let sizes = SizeLimits {
            option: "TriangleMesh::in_unit",
            ..SizeLimits::ANY
        };
        sizes.check(place, extent(&mesh.vertices))?;
        Ok(mesh)
    }

    /// Creates a triangle mesh of any size from vertices in a unit, such as [`LengthUnit::Millimetre`], and checks the invariant.
    ///
    /// # Errors
    /// If the invariant does not hold; errors begin with `place` and count from 1.
    pub fn in_unit(
        place: &str,
        unit: LengthUnit,
        mut vertices: Vec<DVec3>,
        triangles: Vec<[u32; 3]>,
    ) -> Result<Self> {
        vertices
            .iter_mut()
            .for_each(|vertex| *vertex *= unit.metres());
        check_vertices(place, &vertices)?;
        if triangles.is_empty() {
            return Err(Error::input(place, "no triangles", "at least one triangle"));
        }
        check_indices(place, &triangles, vertices.len())?;
        Ok(Self {
            vertices,
            triangles,
        })
    }

    /// Returns the vertices of the mesh, metres.
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Returns three vertex indices per triangle, counter-clockwise seen from outside if the file follows this convention.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Returns the number of triangles.
    pub fn n_triangles(&self) -> usize {
        self.triangles.len()
    }

    /// Returns the triangle with the given index.
    pub fn triangle(&self, triangle: usize) -> Triangle {
        Triangle(self.triangles[triangle].map(|corner| self.vertices[corner as usize]))
    }

    /// Returns the bounding box of all triangles, metres; vertices without a triangle are ignored.
    pub fn bounds(&self) -> Aabb {
        let boxes = (0..self.n_triangles()).map(|t| self.triangle(t).bounds());
        Aabb::around(boxes).expect("a mesh has at least one triangle")
    }

    /// Returns the mesh with the marked triangles turned: their second and third corners are exchanged.
    pub(super) fn with_turned(mut self, is_turned: &[bool]) -> Self {
        for (triangle, is_turned) in self.triangles.iter_mut().zip(is_turned) {
            if *is_turned {
                triangle.swap(1, 2);
            }
        }
        self
    }

    /// Returns the mesh after a rigid motion by `pose`.
    pub fn moved(&self, pose: &Pose) -> Self {
        self.with_vertices(|vertex| pose.transform_point(vertex))
    }

    /// Returns the mesh with each vertex replaced by its image under a map.
    pub(super) fn with_vertices(&self, map: impl Fn(DVec3) -> DVec3) -> Self {
        Self {
            vertices: self.vertices.iter().map(|&vertex| map(vertex)).collect(),
            triangles: self.triangles.clone(),
        }
    }
}

/// Returns the edge lengths of the bounding box of points, metres; zero if there are no points.
pub(super) fn extent(points: &[DVec3]) -> DVec3 {
    let size = Aabb::around_points(points.iter().copied()).size();
    size.max(DVec3::ZERO)
}

/// Returns an error if a face has an index that is not below the number of vertices `n`.
pub(super) fn check_indices(place: &str, faces: &[impl AsRef<[u32]>], n: usize) -> Result<()> {
    for (face, number) in faces.iter().map(AsRef::as_ref).zip(1..) {
        if face.iter().any(|&corner| corner as usize >= n) {
            let given = format!("vertex indices {face:?}");
            let allowed = match n {
                0 => "a part with vertices".to_owned(),
                n => format!("0 to {}, the indices of the vertices", n - 1),
            };
            return Err(Error::input(
                format!("{place}: face {number}"),
                given,
                allowed,
            ));
        }
    }
    Ok(())
}

/// Returns an error if there is no vertex or if a coordinate is not finite.
pub(super) fn check_vertices(place: &str, vertices: &[DVec3]) -> Result<()> {
    if vertices.is_empty() {
        return Err(Error::input(place, "no vertices", "at least one vertex"));
    }
    if let Some(index) = vertices.iter().position(|v| !v.is_finite()) {
        let place = format!("{place}: vertex {}", index + 1);
        return Err(Error::input(place, vertices[index], "finite coordinates"));
    }
    Ok(())
}
