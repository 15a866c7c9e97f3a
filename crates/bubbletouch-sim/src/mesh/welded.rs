//! Shared edges of triangles, found by welding vertices with identical coordinates, independent of the file's indices.

use super::TriangleMesh;
use crate::geometry::place_bits;
use std::collections::HashMap;

/// Triangles of a mesh whose corners with equal coordinates share one index, with the sides of all triangles sorted by edge.
#[derive(Clone, Debug)]
pub struct Welded {
    /// Corners of each triangle. Vertices with equal coordinates share the index of the first of these vertices.
    pub corners: Vec<[u32; 3]>,
    /// Sides of all triangles with three different corners, sorted by edge.
    pub sides: Vec<EdgeSide>,
}

/// Side of a triangle, with the edge of the mesh on which it lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct EdgeSide {
    /// Corners of the edge, the smaller index first.
    pub edge: [u32; 2],
    /// Index of the triangle that has this side.
    pub triangle: u32,
    /// First corner of the side in the triangle (0, 1 or 2); the side ends at the next corner.
    pub side: u8,
    /// Whether the triangle passes the side from the smaller index to the larger.
    pub is_forward: bool,
}

impl Welded {
    /// Merges the corners of a mesh that have equal coordinates, and sorts the sides of its triangles by edge.
    pub fn new(mesh: &TriangleMesh) -> Self {
        let places = places(mesh);
        let corners: Vec<[u32; 3]> = mesh
            .triangles()
            .iter()
            .map(|triangle| triangle.map(|vertex| places[vertex as usize]))
            .collect();
        let mut sides = Vec::with_capacity(3 * corners.len());
        for (triangle, &corners) in corners.iter().enumerate() {
            if has_equal(corners) {
                continue;
            }
            for side in 0..3 {
                let (from, to) = (corners[side], corners[(side + 1) % 3]);
                sides.push(EdgeSide {
                    edge: [from.min(to), from.max(to)],
                    triangle: triangle as u32,
                    side: side as u8,
                    is_forward: from < to,
                });
            }
        }
        sides.sort_unstable();
        Self { corners, sides }
    }

    /// Returns groups of sides, one group for each edge of the mesh.
    pub fn edges(&self) -> impl Iterator<Item = &[EdgeSide]> {
        self.sides.chunk_by(|a, b| a.edge == b.edge)
    }

    /// Returns the number of edges along which the numbers of triangles in the two directions differ. These edges occur at holes and between inconsistently
    /// oriented faces.
    pub fn n_unbalanced(&self) -> usize {
        let is_balanced = |sides: &[EdgeSide]| is_balanced(sides, |side| side.is_forward);
        self.edges().filter(|sides| !is_balanced(sides)).count()
    }

    /// Returns whether every edge has exactly two sides in opposite directions, so that the mesh is closed and consistently oriented.
    pub fn is_closed(&self) -> bool {
        let is_closed = |sides: &[EdgeSide]| sides.len() == 2 && !is_flipped(sides);
        !self.sides.is_empty() && self.edges().all(is_closed)
    }
}

/// Returns whether an edge has two sides in the same direction, so that their triangles disagree about the outside.
pub(super) fn is_flipped(sides: &[EdgeSide]) -> bool {
    sides.len() == 2 && sides[0].is_forward == sides[1].is_forward
}

/// Returns whether equally many triangles pass an edge in both directions; `is_forward` returns the direction of a side.
pub(super) fn is_balanced(sides: &[EdgeSide], is_forward: impl Fn(&EdgeSide) -> bool) -> bool {
    2 * sides.iter().filter(|side| is_forward(side)).count() == sides.len()
}

/// Returns whether two of a triangle's three corners are equal.
pub(super) fn has_equal([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

/// Returns, for each vertex, the index of the first vertex with equal coordinates.
fn places(mesh: &TriangleMesh) -> Vec<u32> {
    let mut first = HashMap::new();
    let vertices = mesh.vertices().iter().enumerate();
    vertices
        .map(|(index, vertex)| *first.entry(place_bits(*vertex)).or_insert(index as u32))
        .collect()
}
