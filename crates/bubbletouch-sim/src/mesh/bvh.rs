//! A tree of boxes over triangles: what is nearest to a point, what a line meets.

use super::slab::{Slab, slabs};
use super::{BoxTree, Feature, Triangle, TriangleMesh};
use crate::geometry::Aabb;
use glam::DVec3;
use std::ops::Range;

/// Triangles in a tree of boxes; the same triangles always give the same tree.
#[derive(Clone, Debug)]
pub struct Bvh {
    tree: BoxTree,
    /// In the tree's order.
    triangles: Vec<Triangle>,
    /// Their planes.
    planes: Vec<Plane>,
    /// Around the triangles of each node.
    slabs: Vec<Slab>,
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

impl Bvh {
    /// The tree of a mesh's triangles.
    pub fn new(mesh: &TriangleMesh) -> Self {
        let triangles = (0..mesh.n_triangles()).map(|t| mesh.triangle(t));
        Self::of(triangles.collect()).expect("a mesh has triangles")
    }

    /// The tree of some triangles, numbered as they come; `None` of none.
    pub fn of(triangles: Vec<Triangle>) -> Option<Self> {
        let tree = BoxTree::new(triangles.iter().map(Triangle::bounds).collect())?;
        let in_order = tree.order().iter().map(|&t| triangles[t as usize]);
        let triangles: Vec<Triangle> = in_order.collect();
        Some(Self {
            planes: triangles.iter().map(Plane::of).collect(),
            slabs: slabs(&tree, &triangles),
            triangles,
            tree,
        })
    }

    /// The tree itself.
    pub(super) fn tree(&self) -> &BoxTree {
        &self.tree
    }

    /// The box around all triangles.
    pub fn bounds(&self) -> Aabb {
        self.tree.bounds()
    }

    /// The triangles of a leaf; of another node none.
    pub(super) fn leaf(&self, node: usize) -> &[Triangle] {
        &self.triangles[self.tree.leaf(node)]
    }

    /// The nearest point of the mesh that is closer than `within` metres (infinity: the nearest of all).
    pub fn closest(&self, point: DVec3, within: f64) -> Option<Closest> {
        let mut found = None;
        let mut visit = |place: usize, limit| {
            if self.planes[place].is_beyond(point, limit) {
                return limit;
            }
            let (on, feature) = self.triangles[place].closest(point);
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
        };
        self.tree.search_unless(
            within * within,
            |bounds| bounds.distance_squared(point),
            |node, limit| self.slabs[node].is_beyond(point, limit),
            |places, limit| places.fold(limit, |limit, place| visit(place, limit)),
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
            |bounds| bounds.entry(origin, direction, range.start),
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
            |bounds| bounds.entry(origin, direction, f64::NEG_INFINITY),
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
        self.tree.order()[place] as usize
    }

    /// The triangles in the tree's order.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// [`search`](Self::search) with places in the tree's order instead of numbers.
    pub fn search_places(
        &self,
        limit: f64,
        bound: impl Fn(&Aabb) -> f64,
        mut visit: impl FnMut(usize, &Triangle, f64) -> f64,
    ) {
        self.tree.search(limit, bound, |places, mut limit| {
            let triangles = &self.triangles[places.clone()];
            for (place, triangle) in places.zip(triangles) {
                limit = visit(place, triangle, limit);
            }
            limit
        });
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
