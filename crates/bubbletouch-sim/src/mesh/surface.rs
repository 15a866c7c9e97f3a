//! Mesh with queries for the nearest point, and for inside and outside.

use super::crossings::winding;
use super::pseudonormals::Pseudonormals;
use super::welded::Welded;
use super::winding::WindingTree;
use super::{Bvh, Closest, Triangle, TriangleMesh};
use crate::geometry::Aabb;
use glam::DVec3;

/// Triangle mesh with the search structures for nearest-point, distance and inside queries.
#[derive(Clone, Debug)]
pub struct Surface {
    mesh: TriangleMesh,
    bvh: Bvh,
    normals: Pseudonormals,
    winding: WindingTree,
    is_closed: bool,
    is_balanced: bool,
}

impl Surface {
    /// Prepares a mesh for nearest-point, distance and inside queries; takes a few microseconds per triangle.
    pub fn new(mesh: TriangleMesh) -> Self {
        let bvh = Bvh::new(&mesh);
        let welded = Welded::new(&mesh);
        Self {
            normals: Pseudonormals::new(&mesh, &welded),
            winding: WindingTree::new(&bvh),
            is_closed: welded.is_closed(),
            is_balanced: welded.n_unbalanced() == 0,
            bvh,
            mesh,
        }
    }

    /// Returns the mesh of the surface.
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// Returns the tree of the triangles' bounding boxes.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// Returns the bounding box of the mesh, metres.
    pub fn bounds(&self) -> Aabb {
        self.bvh.bounds()
    }

    /// Returns whether the mesh is closed: every edge has exactly two consistently oriented faces.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Returns the nearest point of the mesh if it is closer than `within` metres, otherwise `None`. If `within` is infinite, the distance is not limited.
    pub fn closest(&self, point: DVec3, within: f64) -> Option<Closest> {
        self.bvh.closest(point, within)
    }

    /// Returns the outward normal of the mesh at a nearest point. The length of the vector has no meaning; the vector is zero on faces too thin to have a
    /// normal.
    pub fn pseudonormal(&self, closest: &Closest) -> DVec3 {
        self.normals.at(closest.triangle, closest.feature)
    }

    /// Returns the winding number of the surface around a point, with an error of about 0.1. The winding number is 1 inside a closed mesh and 0 outside.
    pub fn winding_number(&self, point: DVec3) -> f64 {
        self.winding.winding_number(&self.bvh, point)
    }

    /// Returns whether a point is in the solid of the mesh, that is, whether its winding number exceeds one half. The result
    /// is exact if every edge has equally many faces in both directions.
    pub fn contains(&self, point: DVec3) -> bool {
        match self.is_balanced {
            true => winding(&self.bvh, point) > 0,
            false => self.winding_number(point) > 0.5,
        }
    }

    /// Returns whether a face of the mesh may intersect this triangle; false if a plane separates the triangle from every face.
    pub fn may_cross(&self, triangle: &Triangle) -> bool {
        let crosses = |_, face: &Triangle| !face.is_apart(triangle);
        self.bvh.any_in_box(&triangle.bounds(), crosses)
    }

    /// Returns the signed distance to the nearest point of the mesh, metres, negative inside. The sign is determined by pseudonormals on a closed mesh,
    /// otherwise by the winding number.
    ///
    /// On a closed mesh that intersects itself, the sign refers only to the nearest face; use `contains` to test whether a point is inside.
    pub fn signed_distance(&self, point: DVec3) -> f64 {
        let Some(closest) = self.closest(point, f64::INFINITY) else {
            // Squared distances overflow beyond 1e154 m; such points are outside.
            return f64::INFINITY;
        };
        if self.is_outside(point, &closest) {
            closest.distance
        } else {
            -closest.distance
        }
    }

    /// Returns whether a point is outside the mesh, given the nearest point of the mesh.
    pub fn is_outside(&self, point: DVec3, closest: &Closest) -> bool {
        let by_normal = match self.is_closed {
            true => self.normals.is_outside(point, closest),
            false => None,
        };
        by_normal.unwrap_or_else(|| !self.contains(point))
    }
}
