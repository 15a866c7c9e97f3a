//! A bounding volume hierarchy: a tree of boxes over triangles, so that a search looks at few of them.

use super::{Feature, Triangle, TriangleMesh};
use crate::geometry::Aabb;
use glam::DVec3;
use std::ops::Range;

/// A tree of boxes in one flat array; the same mesh always gives the same tree.
#[derive(Clone, Debug)]
pub struct Bvh {
    /// The root first; the two children of a node lie side by side.
    nodes: Vec<Node>,
    /// The triangles, leaf by leaf.
    triangles: Vec<Triangle>,
    /// Their numbers in the mesh.
    numbers: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    /// Of a leaf its first triangle, otherwise its first child.
    first: u32,
    /// Zero for a node with children.
    n_triangles: u32,
}

/// The nearest point of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// Metres, not negative.
    pub distance: f64,
    /// Metres.
    pub point: DVec3,
    /// The triangle's number in the mesh.
    pub triangle: usize,
    /// What part of that triangle.
    pub feature: Feature,
}

/// Where a line meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// How far along the line, in lengths of its direction.
    pub along: f64,
    /// The triangle's number in the mesh.
    pub triangle: usize,
}

/// Triangles in a leaf, at most. Larger: more triangles are looked at; smaller: more boxes.
const LEAF: usize = 4;
/// Places where a node may be cut. More: a better tree, made more slowly.
const BINS: usize = 16;
/// From this depth on nodes are cut in half, whatever it costs, so that no tree is deeper than [`STACK`].
const BALANCED_FROM: usize = 24;
/// Nodes that a search may have to come back to: at most one a level, and 32 levels halve 2³² triangles.
const STACK: usize = BALANCED_FROM + 33;

impl Bvh {
    /// The tree of a mesh's triangles.
    pub fn new(mesh: &TriangleMesh) -> Self {
        let mut builder = Builder::new(mesh);
        builder.split(0, 0..mesh.n_triangles(), 0);
        Self {
            nodes: builder.nodes,
            triangles: builder
                .order
                .iter()
                .map(|&t| mesh.triangle(t as usize))
                .collect(),
            numbers: builder.order,
        }
    }

    /// The box around all triangles.
    pub fn bounds(&self) -> Aabb {
        self.nodes[0].bounds
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
        (node.n_triangles == 0).then_some([node.first as usize, node.first as usize + 1])
    }

    /// The triangles of a leaf; of another node none.
    pub(super) fn leaf(&self, node: usize) -> &[Triangle] {
        let node = &self.nodes[node];
        &self.triangles[node.first as usize..][..node.n_triangles as usize]
    }

    /// The nearest point of the mesh that is closer than `within` metres (infinity: the nearest of all).
    pub fn closest(&self, point: DVec3, within: f64) -> Option<Closest> {
        let mut found = None;
        self.search(
            within * within,
            |bounds| bounds.distance_squared(point),
            |number, triangle, limit| {
                let (on, feature) = triangle.closest(point);
                let distance2 = on.distance_squared(point);
                if distance2 >= limit {
                    return limit;
                }
                found = Some(Closest {
                    distance: distance2.sqrt(),
                    point: on,
                    triangle: number,
                    feature,
                });
                distance2
            },
        );
        found
    }

    /// Each triangle whose box meets this one, in the order of the tree: its number in the mesh and its corners.
    pub fn each_in_box(&self, region: &Aabb, mut visit: impl FnMut(usize, &Triangle)) {
        let apart = |a: &Aabb, b: &Aabb| a.min.cmpgt(b.max).any() || b.min.cmpgt(a.max).any();
        let bound = |bounds: &Aabb| f64::from(u8::from(apart(bounds, region)));
        self.search(1.0, bound, |number, triangle, limit| {
            if !apart(&triangle.bounds(), region) {
                visit(number, triangle);
            }
            limit
        });
    }

    /// The first triangle that the line `origin + along · direction` meets for `along` in a range.
    pub fn first_hit(&self, origin: DVec3, direction: DVec3, range: Range<f64>) -> Option<Hit> {
        let mut found = None;
        self.search(
            range.end,
            |bounds| enters(bounds, origin, direction, range.start),
            |triangle_number, triangle, limit| match triangle.crossed_at(origin, direction) {
                Some(along) if along >= range.start && along < limit => {
                    found = Some(Hit {
                        along,
                        triangle: triangle_number,
                    });
                    along
                }
                _ => limit,
            },
        );
        found
    }

    /// Every triangle that the whole line meets, in the order of the tree. A line through an edge may meet both sides or,
    /// by rounding, none.
    pub fn each_hit(&self, origin: DVec3, direction: DVec3, mut visit: impl FnMut(Hit)) {
        self.search(
            f64::INFINITY,
            |bounds| enters(bounds, origin, direction, f64::NEG_INFINITY),
            |triangle_number, triangle, limit| {
                if let Some(along) = triangle.crossed_at(origin, direction) {
                    visit(Hit {
                        along,
                        triangle: triangle_number,
                    });
                }
                limit
            },
        );
    }

    /// Branch and bound: visits the triangles of every leaf whose boxes all have `bound` below the limit, the lower of two
    /// children first. `visit` gets a triangle's number in the mesh, its corners and the limit, and returns the limit
    /// from there on.
    pub fn search(
        &self,
        limit: f64,
        bound: impl Fn(&Aabb) -> f64,
        mut visit: impl FnMut(usize, &Triangle, f64) -> f64,
    ) {
        self.search_places(limit, bound, |place, triangle, limit| {
            visit(self.number(place), triangle, limit)
        });
    }

    /// The number in the mesh of the triangle at a place in the tree's order, in which neighbours lie together.
    pub fn number(&self, place: usize) -> usize {
        self.numbers[place] as usize
    }

    /// The triangles in the tree's order.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// [`search`](Self::search) with places in the tree's order instead of numbers.
    pub fn search_places(
        &self,
        mut limit: f64,
        bound: impl Fn(&Aabb) -> f64,
        mut visit: impl FnMut(usize, &Triangle, f64) -> f64,
    ) {
        let mut waiting = [(0.0, 0_u32); STACK];
        waiting[0] = (bound(&self.nodes[0].bounds), 0);
        let mut n_waiting = 1;
        while n_waiting > 0 {
            n_waiting -= 1;
            let (lowest, node) = waiting[n_waiting];
            if lowest >= limit {
                continue;
            }
            let node = &self.nodes[node as usize];
            if node.n_triangles > 0 {
                let first = node.first as usize;
                let triangles = &self.triangles[first..first + node.n_triangles as usize];
                for (place, triangle) in triangles.iter().enumerate() {
                    limit = visit(first + place, triangle, limit);
                }
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

/// How far along a line it enters a box, at least `from`; infinite if it passes by.
fn enters(bounds: &Aabb, origin: DVec3, direction: DVec3, from: f64) -> f64 {
    let (mut start, mut end) = (from, f64::INFINITY);
    for axis in 0..3 {
        let (low, high) = (
            bounds.min[axis] - origin[axis],
            bounds.max[axis] - origin[axis],
        );
        if direction[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return f64::INFINITY;
            }
            continue;
        }
        let (a, b) = (low / direction[axis], high / direction[axis]);
        start = start.max(a.min(b));
        end = end.min(a.max(b));
    }
    // Rounding must not let a line slip between two boxes that touch.
    if start <= end + 1e-12 * end.abs() {
        start
    } else {
        f64::INFINITY
    }
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
