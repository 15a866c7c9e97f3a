//! Object model of the original \[BT\]: one sphere per mesh vertex.

use super::{Sphere, SphereUnion};
use crate::error::{Error, Result};
use crate::geometry::{Aabb, distinct_places};
use crate::mesh::BoxTree;
use glam::DVec3;

/// Returns a sphere around each vertex. The radius of all spheres is twice the mean distance from a vertex to its nearest neighbour \[BT\].
///
/// Vertices with identical coordinates (in files that repeat a corner for each face) count once. Otherwise their distances would be 0, and the radius would
/// depend on the format of the file. The spheres have the order in which their vertices first occur.
///
/// # Errors
/// If there are fewer than two distinct vertices; the error begins with `place`.
pub fn vertex_spheres(place: &str, vertices: &[DVec3]) -> Result<SphereUnion> {
    let centers = distinct_places(vertices);
    if centers.len() < 2 {
        let allowed = "at least two vertices apart, since the radius is twice their distance";
        return Err(Error::input(place, "all vertices at one place", allowed));
    }
    let distances = nearest_distances(&centers);
    let radius = 2.0 * distances.iter().sum::<f64>() / distances.len() as f64;
    let spheres = centers.into_iter().map(|center| Sphere { center, radius });
    SphereUnion::new(spheres.collect())
}

/// Returns, for each point, the distance to the nearest other point, metres. There must be at least two points, all distinct.
pub(crate) fn nearest_distances(points: &[DVec3]) -> Vec<f64> {
    let boxes = points.iter().map(|&point| Aabb {
        min: point,
        max: point,
    });
    let tree = BoxTree::new(boxes.collect()).expect("there are points");
    let nearest = |number: usize| {
        let point = points[number];
        let mut nearest = f64::INFINITY;
        let bound = |bounds: &Aabb| bounds.distance_squared(point).sqrt();
        tree.search(f64::INFINITY, bound, |places, _| {
            let others = tree.order()[places].iter().map(|&other| other as usize);
            for other in others.filter(|&other| other != number) {
                nearest = nearest.min((points[other] - point).length());
            }
            nearest
        });
        nearest
    };
    (0..points.len()).map(nearest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    #[test]
    fn the_grid_finds_the_same_neighbours_as_trying_all_pairs() {
        for case in 0..60 {
            let mut rng = Seed::new(1).named("neighbours").numbered(case).rng();
            let n = rng.gen_range(2..400);
            let stretch = DVec3::new(1.0, 10f64.powi(-(case as i32 % 4)), (case % 3) as f64);
            let mut point = || DVec3::new(rng.r#gen(), rng.r#gen::<f64>().powi(6), rng.r#gen());
            let points: Vec<DVec3> = (0..n).map(|_| stretch * point()).collect();
            let brute = |i: usize| {
                let others = (0..n).filter(|&j| j != i);
                let distances = others.map(|j| (points[j] - points[i]).length());
                distances.fold(f64::INFINITY, f64::min)
            };
            let expected: Vec<f64> = (0..n).map(brute).collect();
            assert_eq!(nearest_distances(&points), expected, "case {case}");
        }
    }

    #[test]
    fn corners_stored_twice_change_nothing() {
        let once = (0..20).map(|i| DVec3::new(f64::from(i * i), 1.0, -0.0));
        let once: Vec<DVec3> = once.collect();
        let twice = once.iter().flat_map(|&v| [v, DVec3::new(v.x, 1.0, 0.0)]);
        let twice: Vec<DVec3> = twice.collect();
        let union = |v: &[DVec3]| vertex_spheres("test", v).unwrap();
        assert_eq!(union(&once), union(&twice));
    }

    #[test]
    fn the_radius_is_twice_the_mean_distance_to_the_nearest_vertex() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 3.0, 0.0)];
        let union = vertex_spheres("test", &corners).unwrap();
        let expected = 2.0 * (1.0 + 1.0 + 3.0) / 3.0;
        assert!(union.spheres().iter().all(|s| s.radius == expected));
        assert_eq!(union.n_spheres(), 3);
    }

    #[test]
    fn one_place_has_no_radius() {
        let error = vertex_spheres("dot.ply", &[DVec3::ONE; 5]).unwrap_err();
        let said = "dot.ply: all vertices at one place";
        assert!(error.to_string().starts_with(said), "{error}");
    }
}
