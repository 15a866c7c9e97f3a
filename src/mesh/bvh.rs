//! A bounding volume hierarchy: a tree of boxes over triangles, so that a search looks at few of them.

use super::bvh_build::{DEEPEST, Node, build};
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
    /// Their planes.
    planes: Vec<Plane>,
    /// Their numbers in the mesh.
    numbers: Vec<u32>,
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

/// Nodes that a search may have to come back to: at most one a level.
const STACK: usize = DEEPEST + 1;

impl Bvh {
    /// The tree of a mesh's triangles.
    pub fn new(mesh: &TriangleMesh) -> Self {
        let (nodes, numbers) = build(mesh);
        let triangles = numbers.iter().map(|&t| mesh.triangle(t as usize));
        let triangles: Vec<Triangle> = triangles.collect();
        Self {
            planes: triangles.iter().map(Plane::of).collect(),
            triangles,
            nodes,
            numbers,
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
        self.search_places(
            within * within,
            |bounds| bounds.distance_squared(point),
            |place, triangle, limit| {
                if self.planes[place].is_beyond(point, limit) {
                    return limit;
                }
                let (on, feature) = triangle.closest(point);
                let distance2 = on.distance_squared(point);
                if distance2 >= limit {
                    return limit;
                }
                found = Some(Closest {
                    distance: distance2.sqrt(),
                    point: on,
                    triangle: self.number(place),
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

/// The plane of a triangle: no point of the triangle is nearer than it. Where a whole mesh is about equally far, as from the
/// middle of a ball, boxes rule out little, and planes nearly all.
#[derive(Clone, Debug)]
struct Plane {
    /// Of length one; zero where a triangle is too thin to have one.
    normal: DVec3,
    /// Along it.
    offset: f64,
}

impl Plane {
    fn of(triangle: &Triangle) -> Self {
        /// Triangles that are thinner, as a share of their length, have planes that rounding turns too far.
        const THINNEST: f64 = 1e-4;
        let is_thin = 2.0 * triangle.area() <= THINNEST * triangle.longest_edge_squared();
        let normal = match triangle.normal() {
            Some(normal) if !is_thin => normal,
            _ => DVec3::ZERO,
        };
        Self {
            normal,
            offset: normal.dot(triangle.0[0]),
        }
    }

    /// Whether it is certainly farther from a point than the square root of `limit`.
    fn is_beyond(&self, point: DVec3, limit: f64) -> bool {
        let height = self.normal.dot(point) - self.offset;
        height * height > limit * (1.0 + 1e-6)
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
