//! Height at which one triangle of a mesh stops a taxel on a given ray, in double precision.
//!
//! The equations are those of [`swept_triangle`](super::swept_triangle), written without a rotation: z is the height along the ray's direction u, relative
//! to its origin o. For a side e of the triangle, the vector g = e × u is perpendicular to e and u. Its length is the length of the side seen along the
//! ray. A point y relative to the ray's origin is at the distance y·g / |g| beside the side.

use super::swept_triangle::{FACE_SLACK, HIDDEN_SLACK, STEEP};
use super::taxel_lines::Ray;
use crate::objects::mesh_blocks::ContactTriangle;
use glam::DVec3;

/// A triangle relative to a ray.
pub(super) struct TriangleOnRay<'a> {
    triangle: &'a ContactTriangle,
    ray: &'a Ray,
    /// Corners relative to the origin of the ray, metres.
    from: [DVec3; 3],
    /// Heights of the corners, metres.
    heights: [f64; 3],
}

/// Vector e × u of a side, the distance of the ray's origin beside the side times |e × u|, and the sum of the components' absolute values.
#[derive(Clone, Copy)]
struct Side {
    edge: DVec3,
    across: DVec3,
    beside: f64,
    sum: f64,
}

impl<'a> TriangleOnRay<'a> {
    #[inline(always)]
    pub fn new(triangle: &'a ContactTriangle, ray: &'a Ray) -> Self {
        let from = triangle.corners.map(|corner| corner - ray.origin);
        Self {
            triangle,
            ray,
            heights: from.map(|corner| corner.dot(ray.direction)),
            from,
        }
    }

    /// Returns the height of the triangle's lowest corner, metres.
    #[inline(always)]
    pub fn lowest(&self) -> f64 {
        let [a, b, c] = self.heights;
        a.min(b).min(c)
    }

    /// Returns the height at which the triangle stops the taxel, metres; infinite if the triangle misses the taxel.
    ///
    /// If the taxel is under the face, no edge or corner is lower. Otherwise the function evaluates the sides that have the taxel on their outer side, and the
    /// corners of these sides. Edges and corners that belong to another triangle are not evaluated.
    #[inline(always)]
    pub fn stop(&self) -> f64 {
        let face = &self.triangle.face;
        let reach = self.ray.reach;
        let rise = face.normal.dot(self.ray.direction);
        let sides = [self.side(0), self.side(1), self.side(2)];
        let mut is_outside = [true; 3];
        if rise.abs() >= STEEP {
            let shift = if rise > 0.0 { -reach } else { reach };
            is_outside = sides.map(|side| {
                let beside = side.beside + shift * side.across.dot(face.normal);
                let beside = if rise > 0.0 { beside } else { -beside };
                beside < -FACE_SLACK * reach * side.sum
            });
            if is_outside == [false; 3] {
                return (self.from[0].dot(face.normal) + shift) / rise;
            }
        }
        let mut height = f64::INFINITY;
        for k in 0..3 {
            let next = (k + 1) % 3;
            if face.has_edge(k) && is_outside[k] {
                height = height.min(self.edge_height(k, &sides[k]));
            }
            if (is_outside[k] || is_outside[next]) && face.has_corner(next) {
                height = height.min(self.corner_height(next));
            }
        }
        height
    }

    #[inline(always)]
    fn side(&self, k: usize) -> Side {
        let edge = self.triangle.corners[(k + 1) % 3] - self.triangle.corners[k];
        let across = edge.cross(self.ray.direction);
        Side {
            edge,
            across,
            beside: self.from[k].dot(across),
            sum: across.abs().element_sum(),
        }
    }

    /// Returns the height at which the visible part of side `k` stops the taxel, metres; infinite if the taxel misses this part.
    #[inline(always)]
    fn edge_height(&self, k: usize, side: &Side) -> f64 {
        let (reach, face) = (self.ray.reach, &self.triangle.face);
        let length2 = side.across.length_squared();
        let whole2 = side.edge.length_squared();
        let beside = side.beside;
        if length2 <= STEEP * STEEP * whole2 || beside * beside > reach * reach * length2 {
            return f64::INFINITY;
        }
        let slack = HIDDEN_SLACK * reach * side.sum;
        for normal in [face.normal, face.across[k]] {
            let up = normal.dot(self.ray.direction);
            let shift = -reach * normal.dot(side.across);
            let is_hidden = if up > 0.0 {
                beside > slack - shift
            } else {
                (up < 0.0 || shift != 0.0) && beside < shift - slack
            };
            if is_hidden {
                return f64::INFINITY;
            }
        }
        let (length, whole) = (length2.sqrt(), whole2.sqrt());
        let rise = side.edge.dot(self.ray.direction);
        let d = beside / length;
        let r = (reach * reach - d * d).max(0.0).sqrt();
        let z = self.heights[k];
        let ahead = rise * z - side.edge.dot(self.from[k]);
        let foot = ahead / length - r * (rise / whole);
        match foot >= 0.0 && foot <= length {
            true => z + foot * (rise / length) - r * (length / whole),
            false => f64::INFINITY,
        }
    }

    /// Returns the height at which a corner stops the taxel, metres; infinite if the taxel misses the corner.
    #[inline(always)]
    fn corner_height(&self, corner: usize) -> f64 {
        let z = self.heights[corner];
        let aside = self.from[corner] - z * self.ray.direction;
        let q = self.ray.reach * self.ray.reach - aside.length_squared();
        match q > 0.0 {
            true => z - q.sqrt(),
            false => f64::INFINITY,
        }
    }
}
