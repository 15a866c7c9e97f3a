//! Mesh for the unit tests of packing.

use crate::mesh::{Surface, TriangleMesh};
use glam::DVec3;

/// Returns a box with half sizes 3, 2, 1 about the origin.
pub fn brick() -> Surface {
    Surface::new(TriangleMesh::cuboid("brick", DVec3::new(6.0, 4.0, 2.0)).unwrap())
}
