//! Mesh for the unit tests of packing.

use crate::mesh::{Surface, TriangleMesh};
use glam::DVec3;

/// Returns a box with half sizes 3, 2, 1 about the origin.
pub fn brick() -> Surface {
    let corner = |i: u32| {
        let sign = |bit: u32| if i & bit == 0 { -1.0 } else { 1.0 };
        DVec3::new(3.0 * sign(1), 2.0 * sign(2), sign(4))
    };
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let corners = (0..8).map(corner).collect();
    Surface::new(TriangleMesh::new("brick", corners, triangles.collect()).unwrap())
}
