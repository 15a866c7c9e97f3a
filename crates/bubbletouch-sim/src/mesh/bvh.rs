//! Tree of bounding boxes over triangles, for nearest points and line intersections.

use super::{BoxTree, MeshFeature, Triangle, TriangleMesh};
use crate::geometry::Aabb;
use glam::{DMat3, DVec3};
use std::ops::Range;

/// Bounding volume hierarchy: triangles in a tree of bounding boxes. Equal triangles give equal trees.
#[derive(Clone, Debug)]
pub struct Bvh {
    tree: BoxTree,
    /// Triangles in the order of the tree.
    triangles: Vec<Triangle>,
    /// Slab around each triangle, in the order of the tree.
    triangle_slabs: Vec<Slab>,
    /// Slab around the triangles of each node.
    node_slabs: Vec<Slab>,
}

/// Nearest point of a mesh to a query point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// Distance from the query point, metres, not negative.
    pub distance: f64,
    /// Nearest point of the mesh, metres.
    pub point: DVec3,
    /// Index of the triangle that contains the nearest point.
    pub triangle: usize,
    /// Part of the triangle that contains the nearest point.
    pub feature: MeshFeature,
}

/// Intersection of a line and a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Position of the intersection along the line, as a multiple of the line's direction vector.
    pub along: f64,
    /// Index of the intersected triangle in the mesh.
    pub triangle: usize,
}

impl Bvh {
    /// Builds the tree of a mesh's triangles.
    pub fn new(mesh: &TriangleMesh) -> Self {
        let triangles = (0..mesh.n_triangles()).map(|t| mesh.triangle(t));
        Self::from_triangles(triangles.collect()).expect("a mesh has triangles")
    }

    /// Builds the tree of triangles, whose indices are their positions in the vector; `None` if there are no triangles.
    pub fn from_triangles(triangles: Vec<Triangle>) -> Option<Self> {
        let tree = BoxTree::new(triangles.iter().map(Triangle::bounds).collect())?;
        let in_order = tree.order().iter().map(|&t| triangles[t as usize]);
        let triangles: Vec<Triangle> = in_order.collect();
        Some(Self {
            triangle_slabs: triangles.chunks(1).map(Slab::around).collect(),
            node_slabs: slabs(&tree, &triangles),
            triangles,
            tree,
        })
    }

    /// Returns the tree of the triangles' bounding boxes.
    pub(super) fn tree(&self) -> &BoxTree {
        &self.tree
    }

    /// Returns the bounding box of all triangles.
    pub fn bounds(&self) -> Aabb {
        self.tree.bounds()
    }

    /// Returns the triangles of a leaf; none for an inner node.
    pub(super) fn leaf(&self, node: usize) -> &[Triangle] {
        &self.triangles[self.tree.leaf(node)]
    }

    /// Returns the nearest point of the mesh if it is closer than `within` metres, otherwise `None`. If `within` is infinite, the distance is not limited.
    pub fn closest(&self, point: DVec3, within: f64) -> Option<Closest> {
        let mut found = None;
        let mut visit = |place: usize, limit| {
            if self.triangle_slabs[place].is_beyond(point, limit) {
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
            |node, limit| self.node_slabs[node].is_beyond(point, limit),
            |places, limit| places.fold(limit, |limit, place| visit(place, limit)),
        );
        found
    }

    /// Visits each triangle whose bounding box intersects `region`, in the order of the tree, with its index in the mesh.
    pub fn each_in_box(&self, region: &Aabb, mut visit: impl FnMut(usize, &Triangle)) {
        self.any_in_box(region, |number, triangle| {
            visit(number, triangle);
            false
        });
    }

    /// Returns whether `is_found` is true for a triangle whose bounding box intersects `region`. The arguments of `is_found` are the triangle's index in the
    /// mesh and its corners.
    pub(super) fn any_in_box(
        &self,
        region: &Aabb,
        mut is_found: impl FnMut(usize, &Triangle) -> bool,
    ) -> bool {
        let mut found = false;
        let bound = |bounds: &Aabb| f64::from(u8::from(bounds.is_apart(region)));
        self.search(1.0, bound, |number, triangle, limit| {
            found |= !found && !triangle.bounds().is_apart(region) && is_found(number, triangle);
            if found { f64::NEG_INFINITY } else { limit }
        });
        found
    }

    /// Visits each triangle of another mesh that can be within `margin` metres of this mesh. The other mesh is first rotated and translated (metres). A
    /// triangle is visited if the bounding boxes of the triangle and of a triangle of this mesh are within `margin`. More triangles may be visited.
    /// Triangles are visited in the order of the other mesh's tree.
    pub fn each_near(
        &self,
        other: &Self,
        (turn, shift): (&DMat3, DVec3),
        margin: f64,
        mut visit: impl FnMut(usize),
    ) {
        let mut waiting = vec![0];
        while let Some(node) = waiting.pop() {
            let bounds = other.tree.node_bounds(node).turned(turn, shift);
            if !self.any_in_box(&bounds.widened(margin), |_, _| true) {
                continue;
            }
            match other.tree.children(node) {
                Some([one, two]) => waiting.extend([two, one]),
                None => other
                    .tree
                    .leaf(node)
                    .for_each(|place| visit(other.number(place))),
            }
        }
    }

    /// Returns the first triangle that the line `origin + along · direction` crosses, for values of `along` in a range.
    pub fn first_hit(&self, origin: DVec3, direction: DVec3, range: Range<f64>) -> Option<RayHit> {
        let mut found = None;
        self.search(
            range.end,
            |bounds| bounds.entry(origin, direction, range.start),
            |triangle_number, triangle, limit| match triangle.crossed_at(origin, direction) {
                Some(along) if along >= range.start && along < limit => {
                    found = Some(RayHit {
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

    /// Visits triangles by branch and bound. A leaf is visited if `bound` is below the limit for all nodes above it; the child with the lower bound comes
    /// first. `visit` receives a triangle's index in the mesh, its corners and the limit, and returns the new limit.
    pub fn search(
        &self,
        limit: f64,
        bound: impl Fn(&Aabb) -> f64,
        mut visit: impl FnMut(usize, &Triangle, f64) -> f64,
    ) {
        self.tree.search(limit, bound, |places, mut limit| {
            for place in places {
                limit = visit(self.number(place), &self.triangles[place], limit);
            }
            limit
        });
    }

    /// Returns the mesh index of the triangle at the position `place` in the order of the tree.
    pub fn number(&self, place: usize) -> usize {
        self.tree.order()[place] as usize
    }

    /// Returns the triangles in the order of the tree.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }
}

/// Slab around triangles: the space between two parallel planes, the points x with `normal · x` in a range.
///
/// If a surface is nearly flat, a slab is much thinner than a box, especially for surfaces oblique to the axes. If all parts of a mesh are about equally far
/// from a point (such as the middle of a ball), boxes exclude few triangles. Slabs then exclude nearly all triangles.
#[derive(Clone, Copy, Debug)]
struct Slab {
    /// Mean unit normal of the triangles; zero if the triangles have no normal.
    normal: DVec3,
    low: f64,
    high: f64,
}

/// Returns the slab around the triangles of each node of a tree; `triangles` are in the order of the tree.
fn slabs(tree: &BoxTree, triangles: &[Triangle]) -> Vec<Slab> {
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
    fn is_beyond(&self, point: DVec3, limit: f64) -> bool {
        let height = self.normal.dot(point);
        let away = (self.low - height).max(height - self.high).max(0.0);
        away * away > limit * (1.0 + 1e-6)
    }
}
