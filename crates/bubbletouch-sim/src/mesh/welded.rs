//! Which triangles share which edges, whatever the file's indices say: vertices at exactly the same place are one.

use super::TriangleMesh;
use crate::geometry::place_bits;
use std::collections::HashMap;

/// Triangles over welded corners, and all sides of all triangles sorted by edge.
#[derive(Clone, Debug)]
pub struct Welded {
    /// For each triangle its corners; a corner is named by the first vertex at its place.
    pub corners: Vec<[u32; 3]>,
    /// Sides of the triangles with three different corners, sorted by edge; the sides of one edge lie together.
    pub sides: Vec<Side>,
}

/// One side of one triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Side {
    /// Its corners, the smaller first.
    pub edge: [u32; 2],
    /// The triangle's number.
    pub triangle: u32,
    /// From this corner of the triangle (0, 1 or 2) to the next.
    pub side: u8,
    /// Whether the triangle goes from the smaller corner to the larger.
    pub is_forward: bool,
}

impl Welded {
    /// Welds a mesh's corners and sorts its sides.
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
                sides.push(Side {
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

    /// The sides of one edge after another.
    pub fn edges(&self) -> impl Iterator<Item = &[Side]> {
        self.sides.chunk_by(|a, b| a.edge == b.edge)
    }

    /// Edges that are passed more often in one direction than in the other: at holes, and between faces that disagree about
    /// the outside.
    pub fn n_unbalanced(&self) -> usize {
        let sign = |side: &Side| if side.is_forward { 1 } else { -1 };
        let is_unbalanced = |sides: &&[Side]| sides.iter().map(sign).sum::<i32>() != 0;
        self.edges().filter(is_unbalanced).count()
    }

    /// Whether every edge has exactly two sides, in opposite directions: closed, orientable and oriented.
    pub fn is_closed(&self) -> bool {
        let closed =
            |sides: &[Side]| sides.len() == 2 && sides[0].is_forward != sides[1].is_forward;
        !self.sides.is_empty() && self.edges().all(closed)
    }
}

/// Whether a triangle has a corner twice.
pub(super) fn has_equal([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

/// Sets of things that are joined two at a time.
pub(super) struct Joined(Vec<u32>);

impl Joined {
    pub fn of(n: usize) -> Self {
        Self((0..n as u32).collect())
    }

    pub fn root(&mut self, mut thing: u32) -> u32 {
        while self.0[thing as usize] != thing {
            let parent = self.0[thing as usize];
            self.0[thing as usize] = self.0[parent as usize];
            thing = parent;
        }
        thing
    }

    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

/// For each vertex the first one at its place.
fn places(mesh: &TriangleMesh) -> Vec<u32> {
    let mut first = HashMap::new();
    let vertices = mesh.vertices().iter().enumerate();
    vertices
        .map(|(index, vertex)| *first.entry(place_bits(*vertex)).or_insert(index as u32))
        .collect()
}
