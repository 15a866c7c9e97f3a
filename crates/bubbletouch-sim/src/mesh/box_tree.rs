//! Bounding volume hierarchy of boxes, built by the surface area heuristic, which minimises the expected cost of a search.

use crate::geometry::Aabb;
use glam::DVec3;
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

/// Node of the tree of boxes.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    /// Position of the first box if the node is a leaf, otherwise the index of the first child.
    first: u32,
    /// Number of boxes in a leaf; zero for a node with children.
    n_boxes: u32,
}

impl Node {
    /// Returns the positions of a leaf's boxes in the order of the tree; empty for a node with children.
    fn places(&self) -> Range<usize> {
        self.first as usize..(self.first + self.n_boxes) as usize
    }
}

/// Maximum number of boxes in a leaf. If larger, a search tests more boxes; if smaller, the tree has more nodes.
const LEAF: usize = 4;
/// Number of bins per axis, between which a node can be cut. A larger number improves the tree but takes longer to build.
const BINS: usize = 16;
/// Depth of the tree beyond which nodes are cut at the median, whatever the cost.
const BALANCED_FROM: usize = 24;
/// Maximum depth of a tree. Beyond the depth [`BALANCED_FROM`], 32 levels halve 2³² boxes.
const DEEPEST: usize = BALANCED_FROM + 32;

/// Returns the nodes of the tree, and the indices of the boxes leaf by leaf. `root` is the bounding box of all boxes.
fn build(boxes: Vec<Aabb>, root: Aabb) -> (Vec<Node>, Vec<u32>) {
    let n_boxes = boxes.len() as u32;
    let mut builder = Builder {
        centers: boxes.iter().map(Aabb::center).collect(),
        boxes,
        order: (0..n_boxes).collect(),
        nodes: vec![Node {
            bounds: root,
            first: 0,
            n_boxes,
        }],
        right: Vec::new(),
    };
    builder.split(0, 0..n_boxes as usize, 0);
    (builder.nodes, builder.order)
}

struct Builder {
    boxes: Vec<Aabb>,
    centers: Vec<DVec3>,
    order: Vec<u32>,
    nodes: Vec<Node>,
    /// Scratch memory for cutting a node: the indices of the boxes in its second part.
    right: Vec<u32>,
}

impl Builder {
    /// Builds the subtree of the node with index `node`, which contains the boxes `order[range]`.
    fn split(&mut self, node: usize, range: Range<usize>, depth: usize) {
        if range.len() <= LEAF {
            return;
        }
        let (middle, bounds) = self.partition(range.clone(), depth);
        let halves = [range.start..middle, middle..range.end];
        let first = self.nodes.len();
        self.nodes[node].first = first as u32;
        self.nodes[node].n_boxes = 0;
        for (half, bounds) in halves.iter().zip(bounds) {
            self.nodes.push(Node {
                bounds,
                first: half.start as u32,
                n_boxes: half.len() as u32,
            });
        }
        for (child, half) in halves.into_iter().enumerate() {
            self.split(first + child, half, depth + 1);
        }
    }

    fn bounds(&self, range: Range<usize>) -> Aabb {
        let boxes = self.order[range].iter().map(|&t| self.boxes[t as usize]);
        Aabb::around(boxes).expect("no part of the tree is empty")
    }

    /// Divides a range of boxes in two by reordering them. Returns the start of the second part and the bounding boxes of both parts. The cut has the lowest
    /// expected cost (surface area heuristic, cuts at equal distances). The median is used if there is no such cut or the tree is deep.
    fn partition(&mut self, range: Range<usize>, depth: usize) -> (usize, [Aabb; 2]) {
        let centers = &self.centers;
        let order = &mut self.order[range.clone()];
        let spread = Aabb::around_points(order.iter().map(|&t| centers[t as usize]));
        if depth < BALANCED_FROM
            && let Some((cut, bounds)) = Cut::cheapest(&self.boxes, centers, order, &spread)
        {
            self.right.clear();
            let mut n_left = 0;
            for place in 0..order.len() {
                let t = order[place];
                if cut.bin(centers[t as usize]) < cut.first_right {
                    order[n_left] = t;
                    n_left += 1;
                } else {
                    self.right.push(t);
                }
            }
            order[n_left..].copy_from_slice(&self.right);
            return (range.start + n_left, bounds);
        }
        let axis = spread.size().max_position();
        let key = |t: u32| (centers[t as usize][axis], t);
        order.sort_by(|&s, &t| key(s).partial_cmp(&key(t)).expect("vertices are finite"));
        let middle = range.start + range.len() / 2;
        let halves = [range.start..middle, middle..range.end];
        (middle, halves.map(|half| self.bounds(half)))
    }
}

/// Plane across one axis that cuts a node between two bins of box centres.
struct Cut {
    axis: usize,
    low: f64,
    bins_a_metre: f64,
    /// Index of the first bin beyond the plane.
    first_right: usize,
}

impl Cut {
    /// Returns the cheapest cut of a node along any axis, with the bounding boxes of both sides; `None` if the centres of all boxes coincide.
    fn cheapest(
        boxes: &[Aabb],
        centers: &[DVec3],
        order: &[u32],
        spread: &Aabb,
    ) -> Option<(Self, [Aabb; 2])> {
        let size = spread.size();
        let cuts = [0, 1, 2].map(|axis| Self {
            axis,
            low: spread.min[axis],
            bins_a_metre: BINS as f64 / size[axis],
            first_right: 0,
        });
        let mut bins = [[Bin::EMPTY; BINS]; 3];
        for &t in order {
            let (bounds, center) = (&boxes[t as usize], centers[t as usize]);
            for (cut, bins) in cuts.iter().zip(&mut bins) {
                // An axis without extent has 0 bins per metre, so all centres are in the first bin.
                bins[cut.bin(center)].add(bounds, 1);
            }
        }
        let mut best: Option<(f64, Self)> = None;
        for (mut cut, bins) in cuts.into_iter().zip(&bins) {
            if size[cut.axis] <= 0.0 || !cut.bins_a_metre.is_finite() {
                continue;
            }
            let Some((cost, first_right)) = cheapest_plane(bins) else {
                continue;
            };
            cut.first_right = first_right;
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, cut));
            }
        }
        let (_, cut) = best?;
        let bins = bins[cut.axis].split_at(cut.first_right);
        let around = |side: &[Bin]| {
            side.iter()
                .fold(Aabb::EMPTY, |all, bin| all.joined(&bin.bounds))
        };
        Some((cut, [around(bins.0), around(bins.1)]))
    }

    fn bin(&self, center: DVec3) -> usize {
        (((center[self.axis] - self.low) * self.bins_a_metre) as usize).min(BINS - 1)
    }
}

/// Bin: the boxes whose centres lie between two adjacent candidate cuts.
#[derive(Clone, Copy)]
struct Bin {
    /// Bounding box of the boxes in the bin; inverted if the bin is empty.
    bounds: Aabb,
    n_boxes: usize,
}

impl Bin {
    const EMPTY: Self = Self {
        bounds: Aabb::EMPTY,
        n_boxes: 0,
    };

    fn add(&mut self, bounds: &Aabb, n_boxes: usize) {
        self.bounds = self.bounds.joined(bounds);
        self.n_boxes += n_boxes;
    }

    /// Returns the cost of the bin, its surface area times its number of boxes; `None` if the bin is empty.
    fn cost(&self) -> Option<f64> {
        let s = self.bounds.size();
        let area = s.x * s.y + s.y * s.z + s.z * s.x;
        (self.n_boxes > 0).then_some(area * self.n_boxes as f64)
    }
}

/// Returns the lowest total cost of a cut between two bins, and the first bin beyond the cut; `None` if one bin contains all boxes.
fn cheapest_plane(bins: &[Bin; BINS]) -> Option<(f64, usize)> {
    let mut right_costs = [None; BINS];
    let mut right = Bin::EMPTY;
    for bin in (1..BINS).rev() {
        right.add(&bins[bin].bounds, bins[bin].n_boxes);
        right_costs[bin] = right.cost();
    }
    let mut left = Bin::EMPTY;
    let mut best: Option<(f64, usize)> = None;
    for first_right in 1..BINS {
        let bin = &bins[first_right - 1];
        left.add(&bin.bounds, bin.n_boxes);
        if let (Some(left), Some(right)) = (left.cost(), right_costs[first_right]) {
            let cost = left + right;
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, first_right));
            }
        }
    }
    best
}
