//! Construction of a tree of boxes by the surface area heuristic, which minimises the expected cost of a search.

use crate::geometry::Aabb;
use glam::DVec3;
use std::ops::Range;

/// Node of the tree of boxes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub bounds: Aabb,
    /// Position of the first box if the node is a leaf, otherwise the index of the first child.
    pub first: u32,
    /// Number of boxes in a leaf; zero for a node with children.
    pub n_boxes: u32,
}

impl Node {
    /// Returns the positions of a leaf's boxes in the order of the tree; empty for a node with children.
    pub fn places(&self) -> Range<usize> {
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
pub(super) const DEEPEST: usize = BALANCED_FROM + 32;

/// Returns the nodes of the tree, and the indices of the boxes leaf by leaf. `root` is the bounding box of all boxes.
pub(super) fn build(boxes: Vec<Aabb>, root: Aabb) -> (Vec<Node>, Vec<u32>) {
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
        let around = |c: DVec3| Aabb { min: c, max: c };
        let box_of_centers = Aabb::around(order.iter().map(|&t| around(centers[t as usize])));
        let spread = box_of_centers.expect("no part of the tree is empty");
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
        let axis = longest_axis(spread.size());
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
                bins[cut.bin(center)].take(bounds);
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
        let sides = [bins.0, bins.1].map(|side| {
            let mut all = Bin::EMPTY;
            side.iter().for_each(|bin| all.take_all(bin));
            all.bounds
        });
        Some((cut, sides))
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
        bounds: Aabb {
            min: DVec3::INFINITY,
            max: DVec3::NEG_INFINITY,
        },
        n_boxes: 0,
    };

    fn take(&mut self, bounds: &Aabb) {
        self.bounds.min = self.bounds.min.min(bounds.min);
        self.bounds.max = self.bounds.max.max(bounds.max);
        self.n_boxes += 1;
    }

    fn take_all(&mut self, other: &Self) {
        self.bounds.min = self.bounds.min.min(other.bounds.min);
        self.bounds.max = self.bounds.max.max(other.bounds.max);
        self.n_boxes += other.n_boxes;
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
        right.take_all(&bins[bin]);
        right_costs[bin] = right.cost();
    }
    let mut left = Bin::EMPTY;
    let mut best: Option<(f64, usize)> = None;
    for first_right in 1..BINS {
        left.take_all(&bins[first_right - 1]);
        if let (Some(left), Some(right)) = (left.cost(), right_costs[first_right]) {
            let cost = left + right;
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, first_right));
            }
        }
    }
    best
}

fn longest_axis(size: DVec3) -> usize {
    let longest = size.max_element();
    (0..3).find(|&axis| size[axis] == longest).unwrap_or(0)
}
