//! Pseudonormals of faces, edges and corners, which distinguish inside from outside \[BA\].

use super::welded::Welded;
use super::{Closest, MeshFeature, TriangleMesh};
use glam::DVec3;

/// Smallest cosine between a pseudonormal and the direction to the query point for which the pseudonormal determines inside or outside. Below this cosine the
/// winding number decides, because thin triangles have no weight in a pseudonormal.
const FLAT: f64 = 0.05;

/// Pseudonormals of all faces, edges and corners of a mesh. A pseudonormal is the sum of the normals of the adjacent faces, weighted by their angle there.
///
/// A triangle too thin to have a normal has no weight.
#[derive(Clone, Debug)]
pub(super) struct Pseudonormals {
    /// Pseudonormals of the faces, shape (n_triangles,), unit vectors or zero.
    faces: Vec<DVec3>,
    /// Pseudonormals of the edges, shape (n_triangles, 3).
    edges: Vec<[DVec3; 3]>,
    /// Pseudonormals of the corners, shape (n_triangles, 3).
    corners: Vec<[DVec3; 3]>,
}

impl Pseudonormals {
    pub fn new(mesh: &TriangleMesh, welded: &Welded) -> Self {
        let n = mesh.n_triangles();
        let faces: Vec<DVec3> = (0..n)
            .map(|t| mesh.triangle(t).normal().unwrap_or(DVec3::ZERO))
            .collect();
        let mut edges = vec![[DVec3::ZERO; 3]; n];
        for sides in welded.edges() {
            let sum = sides.iter().map(|s| faces[s.triangle as usize]).sum();
            for side in sides {
                edges[side.triangle as usize][usize::from(side.side)] = sum;
            }
        }
        let mut around = vec![DVec3::ZERO; mesh.vertices().len()];
        for (triangle, corners) in welded.corners.iter().enumerate() {
            let at = mesh.triangle(triangle).0;
            for k in 0..3 {
                let (to_next, to_last) = (at[(k + 1) % 3] - at[k], at[(k + 2) % 3] - at[k]);
                let angle = to_next.cross(to_last).length().atan2(to_next.dot(to_last));
                around[corners[k] as usize] += angle * faces[triangle];
            }
        }
        let corners = welded.corners.iter();
        Self {
            edges,
            corners: corners
                .map(|corners| corners.map(|c| around[c as usize]))
                .collect(),
            faces,
        }
    }

    /// Returns the pseudonormal of a face, edge or corner of a triangle. The vector points outwards; its length has no meaning.
    pub fn at(&self, triangle: usize, feature: MeshFeature) -> DVec3 {
        match feature {
            MeshFeature::Face => self.faces[triangle],
            MeshFeature::Edge(k) => self.edges[triangle][usize::from(k)],
            MeshFeature::Vertex(k) => self.corners[triangle][usize::from(k)],
        }
    }

    /// Returns whether a point is outside a closed mesh, given the nearest point of the mesh; `None` if the pseudonormal does not decide.
    pub fn is_outside(&self, point: DVec3, closest: &Closest) -> Option<bool> {
        let normal = self.at(closest.triangle, closest.feature);
        let rise = (point - closest.point).dot(normal);
        (rise.abs() > FLAT * closest.distance * normal.length()).then_some(rise > 0.0)
    }
}
