//! Exact winding number of a mesh without borders, by counting the triangles that a ray crosses.
//!
//! A ray from x to infinity leaves through the front of a triangle (+1) or enters through it (−1). If every edge has equally many triangles in both
//! directions, the sum is the winding number of x for any ray. The result is exact if the ray
//! does not pass close to an edge. Otherwise another direction is used.

use super::winding::solid_angle;
use super::{Bvh, Triangle};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Smallest allowed distance of a ray from an edge of a triangle, in barycentric coordinates. If larger, more rays are rejected; if smaller, rounding may
/// count both triangles at the edge, or none.
const NEAR_EDGE: f64 = 1e-7;

/// Maximum number of ray directions that are tried for one point; about one direction in a million fails.
const MAX_RAYS: usize = 32;

/// Returns the winding number of the triangles around a point, computed with rays.
pub(super) fn winding(bvh: &Bvh, point: DVec3) -> i32 {
    let rays = (0..MAX_RAYS).find_map(|number| along_ray(bvh, point, direction(number)));
    rays.unwrap_or_else(|| {
        let angle: f64 = bvh.triangles().iter().map(|t| solid_angle(t, point)).sum();
        (angle / (4.0 * PI)).round() as i32
    })
}

/// Returns the ray direction with the index `number`. The directions are spread over the sphere by the golden ratio and avoid the axes of typical meshes.
fn direction(number: usize) -> DVec3 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let turns = 0.137 + GOLDEN * number as f64;
    let z = 2.0 * (0.718_281 + turns * GOLDEN).fract() - 1.0;
    let (sin, cos) = (TAU * turns.fract()).sin_cos();
    let across = (1.0 - z * z).sqrt();
    DVec3::new(across * cos, across * sin, z)
}

/// Returns the winding number around a point, computed with one ray; `None` if the ray passes too close to an edge.
fn along_ray(bvh: &Bvh, point: DVec3, direction: DVec3) -> Option<i32> {
    let (mut sum, mut is_clear) = (0, true);
    bvh.search(
        f64::INFINITY,
        |bounds| bounds.entry(point, direction, 0.0),
        |_, triangle, limit| match crossing(triangle, point, direction) {
            Some(sign) => {
                sum += sign;
                limit
            }
            None => {
                is_clear = false;
                f64::NEG_INFINITY
            }
        },
    );
    is_clear.then_some(sum)
}

/// Returns 1 if the ray crosses a triangle from behind, −1 if it enters through the front, and 0 if it misses the triangle. Returns `None` near the
/// triangle's edges. A triangle too thin to have a normal is missed by every ray that avoids the edges of its neighbours.
fn crossing(triangle: &Triangle, origin: DVec3, direction: DVec3) -> Option<i32> {
    let [a, b, c] = triangle.0;
    let (ab, ac, from_a) = (b - a, c - a, origin - a);
    let p = direction.cross(ac);
    let determinant = ab.dot(p);
    let q = from_a.cross(ab);
    let (u, v) = (from_a.dot(p) / determinant, direction.dot(q) / determinant);
    let inside = u.min(v).min(1.0 - u - v);
    if inside.is_nan() || inside < -NEAR_EDGE || ac.dot(q) / determinant <= 0.0 {
        return Some(0);
    }
    if triangle.normal().is_none() {
        return Some(0);
    }
    // The determinant is −(direction · normal) times twice the area.
    (inside > NEAR_EDGE).then_some(if determinant < 0.0 { 1 } else { -1 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::TriangleMesh;

    /// Returns a tetrahedron with a corner at the origin, facing outwards or inwards.
    fn tetrahedron(size: f64, is_outwards: bool) -> Vec<Triangle> {
        let [o, x, y, z] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| size * p);
        let faces = [[o, y, x], [o, x, z], [o, z, y], [x, y, z]];
        let turn = |[a, b, c]: [DVec3; 3]| if is_outwards { [a, b, c] } else { [a, c, b] };
        faces.map(|face| Triangle(turn(face))).to_vec()
    }

    #[test]
    fn parts_add_up_and_cavities_count_against_them() {
        let parts = [
            tetrahedron(1.0, true),
            tetrahedron(0.9, true),
            tetrahedron(0.3, false),
        ];
        let bvh = Bvh::from_triangles(parts.concat()).unwrap();
        for (place, expected) in [(0.05, 1), (0.2, 2), (0.31, 1), (0.34, 0), (-0.01, 0)] {
            assert_eq!(winding(&bvh, DVec3::splat(place)), expected, "at {place}");
        }
    }

    #[test]
    fn a_point_beside_a_face_is_on_its_side_of_it() {
        let mesh = tetrahedron(1.0, true);
        let corners = mesh.iter().flat_map(|t| t.0).collect();
        let triangles = vec![[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]];
        let mesh = TriangleMesh::new("tetrahedron", corners, triangles).unwrap();
        let bvh = Bvh::new(&mesh);
        for triangle in (0..4).map(|t| mesh.triangle(t)) {
            let lift = 1e-9 * triangle.normal().unwrap();
            assert_eq!(winding(&bvh, triangle.middle() + lift), 0);
            assert_eq!(winding(&bvh, triangle.middle() - lift), 1);
        }
    }
}
