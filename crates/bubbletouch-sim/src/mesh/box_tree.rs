//! A bounding volume hierarchy of anything that has a box, so that a search looks at few of them.

use super::box_tree_build::{DEEPEST, Node, build};
use crate::geometry::Aabb;
use std::ops::Range;

/// A tree of boxes in one flat array; the same boxes always give the same tree.
#[derive(Clone, Debug)]
pub struct BoxTree {
    /// The root first; the two children of a node lie side by side.
    nodes: Vec<Node>,
    /// Numbers of the boxes, leaf by leaf.
    order: Vec<u32>,
}

/// Nodes that a search may have to come back to: at most one a level.
const STACK: usize = DEEPEST + 1;

impl BoxTree {
    /// The tree of these boxes, metres; `None` of none.
    pub fn new(boxes: Vec<Aabb>) -> Option<Self> {
        let root = Aabb::around(boxes.iter().copied())?;
        let (nodes, order) = build(boxes, root);
        Some(Self { nodes, order })
    }

    /// The box around all.
    pub fn bounds(&self) -> Aabb {
        self.nodes[0].bounds
    }

    /// The boxes' numbers in the tree's order, in which neighbours lie together.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// How many nodes; node 0 is the root, children come after their parents.
    pub(super) fn n_nodes(&self) -> usize {
        self.nodes.len()
    }

    pub(super) fn node_bounds(&self, node: usize) -> &Aabb {
        &self.nodes[node].bounds
    }

    /// The two children of a node; `None` of a leaf.
    pub(super) fn children(&self, node: usize) -> Option<[usize; 2]> {
        let node = &self.nodes[node];
        (node.n_boxes == 0).then_some([node.first as usize, node.first as usize + 1])
    }

    /// Where in the tree's order the boxes of a leaf lie; of another node none do.
    pub(super) fn leaf(&self, node: usize) -> Range<usize> {
        self.nodes[node].places()
    }

    /// Branch and bound: visits every leaf whose boxes up to the root all have `bound` below the limit, the lower of two
    /// children first. `visit` gets the leaf's places in the tree's [order](Self::order) and the limit, and returns the limit
    /// from there on.
    pub fn search(
        &self,
        limit: f64,
        bound: impl Fn(&Aabb) -> f64,
        visit: impl FnMut(Range<usize>, f64) -> f64,
    ) {
        self.search_unless(limit, bound, |_, _| false, visit);
    }

    /// [`search`](Self::search) that also passes by the nodes that `rules_out`, asked with their number and the limit when
    /// their turn comes.
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
