//! Bounding volume hierarchy of boxes.

use super::box_tree_build::{DEEPEST, Node, build};
use crate::geometry::Aabb;
use std::ops::Range;

/// Tree of boxes in one flat array. Equal boxes give equal trees.
#[derive(Clone, Debug)]
pub struct BoxTree {
    /// Nodes of the tree, the root first; the two children of a node are adjacent.
    nodes: Vec<Node>,
    /// Indices of the boxes, leaf by leaf.
    order: Vec<u32>,
}

/// Maximum number of nodes that wait during a search: one per level of the tree.
const STACK: usize = DEEPEST + 1;

impl BoxTree {
    /// Builds the tree of the given bounding boxes, metres; `None` if there are no boxes.
    pub fn new(boxes: Vec<Aabb>) -> Option<Self> {
        let root = Aabb::around(boxes.iter().copied())?;
        let (nodes, order) = build(boxes, root);
        Some(Self { nodes, order })
    }

    /// Returns the bounding box of all boxes in the tree.
    pub fn bounds(&self) -> Aabb {
        self.nodes[0].bounds
    }

    /// Returns the indices of the boxes in the order of the tree, where neighbours are adjacent.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Returns the number of nodes of the tree; node 0 is the root, and children come after their parents.
    pub(super) fn n_nodes(&self) -> usize {
        self.nodes.len()
    }

    pub(super) fn node_bounds(&self, node: usize) -> &Aabb {
        &self.nodes[node].bounds
    }

    /// Returns the two children of a node; `None` for a leaf.
    pub(super) fn children(&self, node: usize) -> Option<[usize; 2]> {
        let node = &self.nodes[node];
        (node.n_boxes == 0).then_some([node.first as usize, node.first as usize + 1])
    }

    /// Returns the positions of a leaf's boxes in the order of the tree; empty for an inner node.
    pub(super) fn leaf(&self, node: usize) -> Range<usize> {
        self.nodes[node].places()
    }

    /// Visits leaves by branch and bound. A leaf is visited if `bound` is below the limit for all nodes above it; the child with the lower bound comes first.
    /// `visit` receives the positions of the leaf's boxes in the tree's order and the limit, and returns the new limit.
    pub fn search(
        &self,
        limit: f64,
        bound: impl Fn(&Aabb) -> f64,
        visit: impl FnMut(Range<usize>, f64) -> f64,
    ) {
        self.search_unless(limit, bound, |_, _| false, visit);
    }

    /// Visits leaves by branch and bound, as `search` does, but skips nodes for which `rules_out` returns true. The arguments of `rules_out` are the node's
    /// index and the current limit.
    pub(super) fn search_unless(
        &self,
        mut limit: f64,
        bound: impl Fn(&Aabb) -> f64,
        rules_out: impl Fn(usize, f64) -> bool,
        mut visit: impl FnMut(Range<usize>, f64) -> f64,
    ) {
        let mut waiting = [(0.0, 0_u32); STACK];
        waiting[0] = (bound(&self.nodes[0].bounds), 0);
        let mut n_waiting = 1;
        while n_waiting > 0 {
            n_waiting -= 1;
            let (lowest, node) = waiting[n_waiting];
            if lowest >= limit || rules_out(node as usize, limit) {
                continue;
            }
            let node = &self.nodes[node as usize];
            if node.n_boxes > 0 {
                limit = visit(node.places(), limit);
                continue;
            }
            let child = |number: u32| (bound(&self.nodes[number as usize].bounds), number);
            let (first, second) = (child(node.first), child(node.first + 1));
            let (near, far) = if second.0 < first.0 {
                (second, first)
            } else {
                (first, second)
            };
            for (bound, number) in [far, near] {
                if bound < limit {
                    waiting[n_waiting] = (bound, number);
                    n_waiting += 1;
                }
            }
        }
    }
}
