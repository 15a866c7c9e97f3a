//! Distances between spheres and their mesh, measured at sample points; unlike the tolerance of a packing they are not proved.

use super::target::Body;
use crate::geometry::Aabb;
use crate::mesh::{BoxTree, Surface, Triangle};
use crate::objects::{Sphere, SphereUnion};
use crate::random::Seed;
use glam::DVec3;
use rand::Rng;

/// Mean, 95th percentile and maximum of the distances at many points, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DistanceStatistics {
    /// Mean distance over all points, zeros included, metres.
    pub mean: f64,
    /// 95th percentile of the distances over all points, metres.
    pub p95: f64,
    /// Largest distance over all points, metres.
    pub max: f64,
}

/// Distances between the surfaces of a mesh and of spheres, at points distributed uniformly over the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackingError {
    /// Height of the spheres' surface above the mesh, along the normal of the mesh; 0 where the spheres' surface lies inside the mesh.
    pub protrusion: DistanceStatistics,
    /// Distance from the mesh's surface to the spheres; 0 where the mesh's surface lies inside the spheres.
    pub gap: DistanceStatistics,
    /// Number of tested points on the outer surface of the mesh.
    pub n_points: usize,
    /// Fraction of all points that are not on the outer surface, because they lie inside other parts of the mesh.
    pub buried_share: f64,
}

/// Measures protrusion and gap at `n_points` points of the mesh. The area is divided into `n_points` equal parts with one random
/// point in each; the points depend only on the mesh and on `n_points`.
pub fn packing_error(
    surface: &Surface,
    body: Body,
    spheres: &SphereUnion,
    n_points: usize,
) -> PackingError {
    let tree = SphereTree::new(spheres);
    let (mut protrusions, mut gaps) = (Vec::new(), Vec::new());
    let points = surface_points(surface, n_points);
    for &(point, normal) in &points {
        let lift = 1e-9 * surface.bounds().size().length();
        if body == Body::Solid && surface.contains(point + lift * normal) {
            continue;
        }
        let gap = tree.distance(point);
        gaps.push(gap);
        protrusions.push(if gap > 0.0 {
            0.0
        } else {
            protrusion(surface, &tree, point, normal)
        });
    }
    PackingError {
        n_points: gaps.len(),
        buried_share: 1.0 - gaps.len() as f64 / points.len().max(1) as f64,
        protrusion: spread(protrusions),
        gap: spread(gaps),
    }
}

/// Returns how far the spheres protrude from the mesh along `normal` at a point of the mesh, metres. The point must be inside the spheres.
fn protrusion(surface: &Surface, tree: &SphereTree, point: DVec3, normal: DVec3) -> f64 {
    let end = tree.end(point, normal);
    match surface.closest(end, f64::INFINITY) {
        Some(nearest) if !surface.contains(end) => nearest.distance,
        // The spheres close a narrow cleft here, so there is no outer surface.
        _ => 0.0,
    }
}

/// Returns one random point in each of `n_points` equal parts of the mesh's area, with its outward normal.
pub(super) fn surface_points(surface: &Surface, n_points: usize) -> Vec<(DVec3, DVec3)> {
    let mesh = surface.mesh();
    let area = mesh.area();
    let mut rng = Seed::new(n_points as u64).named("packing error").rng();
    let mut points = Vec::with_capacity(n_points);
    let mut passed = 0.0;
    let mut next = rng.r#gen::<f64>();
    for triangle in (0..mesh.n_triangles()).map(|t| mesh.triangle(t)) {
        passed += triangle.area() / area * n_points as f64;
        while next < passed {
            if let Some(normal) = triangle.normal() {
                points.push((point_in(&triangle, &mut rng), normal));
            }
            next = next.floor() + 1.0 + rng.r#gen::<f64>();
        }
    }
    points
}

fn point_in(triangle: &Triangle, rng: &mut impl Rng) -> DVec3 {
    let [a, b, c] = triangle.0;
    let (u, v): (f64, f64) = (rng.r#gen(), rng.r#gen());
    let (u, v) = if u + v > 1.0 {
        (1.0 - u, 1.0 - v)
    } else {
        (u, v)
    };
    a + u * (b - a) + v * (c - a)
}

fn spread(mut values: Vec<f64>) -> DistanceStatistics {
    if values.is_empty() {
        return DistanceStatistics::default();
    }
    values.sort_by(f64::total_cmp);
    let n = values.len();
    DistanceStatistics {
        mean: values.iter().sum::<f64>() / n as f64,
        p95: values[((0.95 * n as f64).ceil() as usize).clamp(1, n) - 1],
        max: values[n - 1],
    }
}

/// Bounding volume tree of spheres.
struct SphereTree {
    tree: BoxTree,
    /// Spheres, in the order of the tree.
    spheres: Vec<Sphere>,
}

impl SphereTree {
    fn new(union: &SphereUnion) -> Self {
        let boxes = union.spheres().iter().map(Sphere::bounds).collect();
        let tree = BoxTree::new(boxes).expect("a union has spheres");
        let in_order = tree.order().iter().map(|&s| union.spheres()[s as usize]);
        Self {
            spheres: in_order.collect(),
            tree,
        }
    }

    /// Returns the distance from a point to the spheres, metres; 0 inside.
    fn distance(&self, point: DVec3) -> f64 {
        let mut least = f64::INFINITY;
        let bound = |bounds: &Aabb| bounds.distance_squared(point).sqrt();
        self.tree.search(f64::INFINITY, bound, |places, _| {
            for sphere in &self.spheres[places] {
                least = least.min((point.distance(sphere.center) - sphere.radius).max(0.0));
            }
            least
        });
        least
    }

    /// Returns the point at which a ray leaves all spheres for the first time. The ray starts at a point inside the spheres.
    fn end(&self, start: DVec3, direction: DVec3) -> DVec3 {
        let mut along = 0.0;
        loop {
            let point = start + along * direction;
            let mut end = along;
            let outside = |bounds: &Aabb| bounds.distance_squared(point);
            self.tree
                .search(f64::MIN_POSITIVE, outside, |places, limit| {
                    for &Sphere { center, radius } in &self.spheres[places] {
                        if point.distance_squared(center) <= radius * radius {
                            let h = (center - start).dot(direction);
                            let b2 = start.distance_squared(center) - h * h;
                            end = f64::max(end, h + (radius * radius - b2).max(0.0).sqrt());
                        }
                    }
                    limit
                });
            if end <= along * (1.0 + 1e-12) {
                return point;
            }
            along = end;
        }
    }
}
