//! A mesh that answers where its nearest point is, and on which side of it a point lies.

use super::crossings::winding;
use super::pseudonormals::Pseudonormals;
use super::welded::Welded;
use super::winding::WindingTree;
use super::{Bvh, Closest, Triangle, TriangleMesh};
use crate::geometry::Aabb;
use glam::DVec3;

/// A mesh with everything that its queries need.
#[derive(Clone, Debug)]
pub struct Surface {
    mesh: TriangleMesh,
    bvh: Bvh,
    normals: Pseudonormals,
    winding: WindingTree,
    is_closed: bool,
    is_balanced: bool,
}

/// Below this cosine between a pseudonormal and the way to the point its sign is not trusted: thin triangles count nothing
/// in it. The winding number decides there.
const FLAT: f64 = 0.05;

impl Surface {
    /// Prepares a mesh; a few microseconds a triangle.
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

    /// The mesh.
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// Its tree of boxes.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// The box around it, metres.
    pub fn bounds(&self) -> Aabb {
        self.bvh.bounds()
    }

    /// Whether every edge has exactly two faces that agree about the outside.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// The nearest point that is closer than `within` metres (infinity: the nearest of all).
    pub fn closest(&self, point: DVec3, within: f64) -> Option<Closest> {
        self.bvh.closest(point, within)
    }

    /// The normal of what a nearest point lies on, outwards, of any length; zero on faces too thin to have one.
    pub fn pseudonormal(&self, closest: &Closest) -> DVec3 {
        self.normals.at(closest.triangle, closest.feature)
    }

    /// How often the surface goes around a point: 1 inside a closed mesh, 0 outside; within about 0.1.
    pub fn winding_number(&self, point: DVec3) -> f64 {
        self.winding.winding_number(&self.bvh, point)
    }

    /// Whether a point is in the [solid](crate::mesh#the-solid-of-a-mesh) of the mesh: its winding number exceeds one half. Exact
    /// if every edge is passed as often in one direction as in the other.
    pub fn contains(&self, point: DVec3) -> bool {
        match self.is_balanced {
            true => winding(&self.bvh, point) > 0,
            false => self.winding_number(point) > 0.5,
        }
    }

    /// Whether a face of the mesh may meet this triangle: not said if all are certainly [apart](Triangle::is_apart) from it.
    pub fn may_cross(&self, triangle: &Triangle) -> bool {
        let bounds = triangle.bounds();
        let mut is_crossed = false;
        let apart = |b: &Aabb| b.min.cmpgt(bounds.max).any() || bounds.min.cmpgt(b.max).any();
        self.bvh.search(
            1.0,
            |b| f64::from(u8::from(apart(b))),
            |_, face, limit| {
                is_crossed |= !apart(&face.bounds()) && !face.is_apart(triangle);
                if is_crossed { f64::NEG_INFINITY } else { limit }
            },
        );
        is_crossed
    }

    /// Metres to the nearest point, negative inside: by pseudonormals on a closed mesh, otherwise by winding number.
    ///
    /// On a closed mesh that cuts through itself the sign is that of the nearest sheet; [`contains`](Self::contains) knows
    /// better there.
    pub fn signed_distance(&self, point: DVec3) -> f64 {
        let Some(closest) = self.closest(point, f64::INFINITY) else {
            // Squared distances overflow beyond 1e154 m: that is outside.
            return f64::INFINITY;
        };
        if self.is_outside(point, &closest) {
            closest.distance
        } else {
            -closest.distance
        }
    }

    /// The side of a point whose nearest point is known.
    pub fn is_outside(&self, point: DVec3, closest: &Closest) -> bool {
        if self.is_closed {
            let normal = self.pseudonormal(closest);
            let rise = (point - closest.point).dot(normal);
            if rise.abs() > FLAT * closest.distance * normal.length() {
                return rise > 0.0;
            }
        }
        !self.contains(point)
    }
}
