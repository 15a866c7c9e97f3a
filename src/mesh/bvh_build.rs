//! How the tree of boxes is made: cut where a search is expected to cost least (surface area heuristic).

use super::TriangleMesh;
use crate::geometry::Aabb;
use glam::DVec3;
use std::ops::Range;

/// A box of the tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub bounds: Aabb,
    /// Of a leaf its first triangle, otherwise its first child.
    pub first: u32,
    /// Zero for a node with children.
    pub n_triangles: u32,
}

/// Triangles in a leaf, at most. Larger: more triangles are looked at; smaller: more boxes.
const LEAF: usize = 4;
/// Places where a node may be cut. More: a better tree, made more slowly.
const BINS: usize = 16;
/// From this depth on nodes are cut in half, whatever it costs.
const BALANCED_FROM: usize = 24;
/// No tree is deeper: 32 levels halve 2³² triangles.
pub(super) const DEEPEST: usize = BALANCED_FROM + 32;
/// The nodes of a mesh's tree and its triangles' numbers, leaf by leaf.
pub(super) fn build(mesh: &TriangleMesh) -> (Vec<Node>, Vec<u32>) {
    let mut builder = Builder::new(mesh);
    builder.split(0, 0..mesh.n_triangles(), 0);
    (builder.nodes, builder.order)
}

struct Builder {
    boxes: Vec<Aabb>,
    centers: Vec<DVec3>,
    order: Vec<u32>,
    nodes: Vec<Node>,
}

impl Builder {
    fn new(mesh: &TriangleMesh) -> Self {
        let boxes: Vec<Aabb> = (0..mesh.n_triangles())
            .map(|t| mesh.triangle(t).bounds())
            .collect();
        let root = Node {
            bounds: mesh.bounds(),
            first: 0,
            n_triangles: mesh.n_triangles() as u32,
        };
        Self {
            centers: boxes.iter().map(Aabb::center).collect(),
            order: (0..mesh.n_triangles() as u32).collect(),
            nodes: vec![root],
            boxes,
        }
    }

    /// Makes the tree below a node that holds `order[range]`.
    fn split(&mut self, node: usize, range: Range<usize>, depth: usize) {
        if range.len() <= LEAF {
            return;
        }
        let middle = self.partition(range.clone(), depth);
        let halves = [range.start..middle, middle..range.end];
        let first = self.nodes.len();
        self.nodes[node].first = first as u32;
        self.nodes[node].n_triangles = 0;
        for half in &halves {
            self.nodes.push(Node {
                bounds: self.bounds(half.clone()),
                first: half.start as u32,
                n_triangles: half.len() as u32,
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

    /// Reorders a range and returns where its second part starts: the cut with the least expected cost (surface area
    /// heuristic, cuts at equal distances), or the median where that is no cut or the tree is deep.
    fn partition(&mut self, range: Range<usize>, depth: usize) -> usize {
        let centers = &self.centers;
        let order = &mut self.order[range.clone()];
        let around = |c: DVec3| Aabb { min: c, max: c };
        let box_of_centers = Aabb::around(order.iter().map(|&t| around(centers[t as usize])));
        let spread = box_of_centers.expect("no part of the tree is empty");
        if depth < BALANCED_FROM
            && let Some(cut) = Cut::cheapest(&self.boxes, centers, order, &spread)
        {
            let (mut left, right): (Vec<u32>, Vec<u32>) = order
                .iter()
                .partition(|&&t| cut.bin(centers[t as usize]) < cut.first_right);
            let middle = range.start + left.len();
            left.extend(right);
            order.copy_from_slice(&left);
            return middle;
        }
        let axis = longest_axis(spread.size());
        let key = |t: u32| (centers[t as usize][axis], t);
        order.sort_by(|&s, &t| key(s).partial_cmp(&key(t)).expect("vertices are finite"));
        range.start + range.len() / 2
    }
}

/// A plane across one axis between two bins of centres.
struct Cut {
    axis: usize,
    low: f64,
    bins_a_metre: f64,
    /// The first bin of the second part.
    first_right: usize,
}

impl Cut {
    /// The best along the longest axis; `None` if all centres are at one place.
    fn cheapest(boxes: &[Aabb], centers: &[DVec3], order: &[u32], spread: &Aabb) -> Option<Self> {
        let mut best: Option<(f64, Self)> = None;
        for axis in 0..3 {
            let size = spread.size()[axis];
            if size <= 0.0 || !(BINS as f64 / size).is_finite() {
                continue;
            }
            let mut cut = Self {
                axis,
                low: spread.min[axis],
                bins_a_metre: BINS as f64 / size,
                first_right: 0,
            };
            let mut bins: [Option<(Aabb, usize)>; BINS] = [None; BINS];
            for &t in order {
                let bin = &mut bins[cut.bin(centers[t as usize])];
                *bin = merged(*bin, Some((boxes[t as usize], 1)));
            }
            let Some((cost, first_right)) = cheapest_plane(&bins) else {
                continue;
            };
            cut.first_right = first_right;
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, cut));
            }
        }
        best.map(|(_, cut)| cut)
    }

    fn bin(&self, center: DVec3) -> usize {
        (((center[self.axis] - self.low) * self.bins_a_metre) as usize).min(BINS - 1)
    }
}

/// The least cost, Σ area · triangles over both sides, and its first bin on the right; `None` if one bin has them all.
fn cheapest_plane(bins: &[Option<(Aabb, usize)>; BINS]) -> Option<(f64, usize)> {
    let mut right_costs = [None; BINS];
    let mut right = None;
    for bin in (1..BINS).rev() {
        right = merged(right, bins[bin]);
        right_costs[bin] = right.map(cost);
    }
    let mut left = None;
    let mut best: Option<(f64, usize)> = None;
    for first_right in 1..BINS {
        left = merged(left, bins[first_right - 1]);
        if let (Some(left), Some(right)) = (left.map(cost), right_costs[first_right]) {
            let cost = left + right;
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, first_right));
            }
        }
    }
    best
}

fn cost((bounds, n): (Aabb, usize)) -> f64 {
    let s = bounds.size();
    (s.x * s.y + s.y * s.z + s.z * s.x) * n as f64
}

fn merged(a: Option<(Aabb, usize)>, b: Option<(Aabb, usize)>) -> Option<(Aabb, usize)> {
    let (Some(a), Some(b)) = (a, b) else {
        return a.or(b);
    };
    let both = Aabb {
        min: a.0.min.min(b.0.min),
        max: a.0.max.max(b.0.max),
    };
    Some((both, a.1 + b.1))
}

fn longest_axis(size: DVec3) -> usize {
    let longest = size.max_element();
    (0..3).find(|&axis| size[axis] == longest).unwrap_or(0)
}
