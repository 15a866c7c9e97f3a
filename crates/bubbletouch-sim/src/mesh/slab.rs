//! Slabs: pairs of parallel planes that enclose all triangles below a node of a tree.
//!
//! If a surface is nearly flat, a slab is much thinner than a box, especially for surfaces oblique to the axes. If all parts of a mesh are about equally far
//! from a point (such as the middle of a ball), boxes exclude few triangles. Slabs then exclude nearly all triangles.

use super::{BoxTree, Triangle};
use glam::DVec3;
use std::ops::Range;

/// Space between two parallel planes: the points x with `normal · x` in a range.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slab {
    /// Mean unit normal of the triangles; zero if the triangles have no normal.
    normal: DVec3,
    low: f64,
    high: f64,
}

/// Returns the slab around the triangles of each node of a tree; `triangles` are in the order of the tree.
pub(super) fn slabs(tree: &BoxTree, triangles: &[Triangle]) -> Vec<Slab> {
    let mut places: Vec<Range<usize>> = vec![0..0; tree.n_nodes()];
    // Children come after their parents, and their triangles are adjacent.
    for node in (0..tree.n_nodes()).rev() {
        places[node] = match tree.children(node) {
            Some([left, right]) => places[left].start..places[right].end,
            None => tree.leaf(node),
        };
    }
    let slab = |places| Slab::around(&triangles[places]);
    places.into_iter().map(slab).collect()
}

impl Slab {
    fn around(triangles: &[Triangle]) -> Self {
        let area: DVec3 = triangles.iter().map(Triangle::double_area).sum();
        let normal = area.normalize_or_zero();
        let heights = triangles.iter().flat_map(|t| t.0).map(|p| normal.dot(p));
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| {
            (low.min(z), high.max(z))
        });
        Self { normal, low, high }
    }

    /// Returns whether the slab is certainly farther from a point than the square root of `limit` (a squared distance).
    pub fn is_beyond(&self, point: DVec3, limit: f64) -> bool {
        let height = self.normal.dot(point);
        let away = (self.low - height).max(height - self.high).max(0.0);
        away * away > limit * (1.0 + 1e-6)
    }
}
