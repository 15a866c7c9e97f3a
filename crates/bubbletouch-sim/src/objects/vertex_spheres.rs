//! Object model of the original \[BT\]: one sphere per mesh vertex.

use super::{Sphere, SphereUnion};
use crate::error::{Error, Result};
use crate::geometry::distinct_places;
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
        return Err(Error::input(
            place,
            "all vertices at one place",
            "at least two vertices apart, since the radius is twice their distance",
        ));
    }
    let distances = nearest_distances(&centers);
    let radius = 2.0 * distances.iter().sum::<f64>() / distances.len() as f64;
    let spheres = centers.into_iter().map(|center| Sphere { center, radius });
    SphereUnion::new(spheres.collect())
}

/// Returns, for each point, the distance to the nearest other point, metres. There must be at least two points, all distinct.
///
/// The points lie in the cells of a uniform grid. Rings of cells around a point's own cell are searched until no remaining
/// cell can contain a nearer point.
pub(crate) fn nearest_distances(points: &[DVec3]) -> Vec<f64> {
    let grid = PointGrid::new(points);
    (0..points.len()).map(|i| grid.nearest(i)).collect()
}

struct PointGrid<'a> {
    points: &'a [DVec3],
    low: DVec3,
    cell: f64,
    n: [usize; 3],
    /// Index of the first point of each cell; the points of cell k are `order[starts[k]..starts[k + 1]]`.
    starts: Vec<usize>,
    order: Vec<usize>,
}

impl<'a> PointGrid<'a> {
    fn new(points: &'a [DVec3]) -> Self {
        let low = points.iter().copied().fold(DVec3::MAX, DVec3::min);
        let high = points.iter().copied().fold(DVec3::MIN, DVec3::max);
        let size = high - low;
        // About one point per cell on a surface, whose area is about longest². More than 128 cells per axis would cost
        // more memory than the saved time justifies.
        let longest = size.max_element();
        let cell = longest / (points.len() as f64).sqrt().clamp(1.0, 128.0);
        let n = (size / cell).to_array().map(|s| s as usize + 1);
        let mut grid = Self {
            points,
            low,
            cell,
            n,
            starts: vec![0; n[0] * n[1] * n[2] + 1],
            order: vec![0; points.len()],
        };
        let cells: Vec<usize> = points.iter().map(|&p| grid.index(grid.place(p))).collect();
        for &cell in &cells {
            grid.starts[cell + 1] += 1;
        }
        for k in 1..grid.starts.len() {
            grid.starts[k] += grid.starts[k - 1];
        }
        let mut next = grid.starts.clone();
        for (point, &cell) in cells.iter().enumerate() {
            grid.order[next[cell]] = point;
            next[cell] += 1;
        }
        grid
    }

    fn place(&self, point: DVec3) -> [usize; 3] {
        let at = ((point - self.low) / self.cell).to_array();
        [0, 1, 2].map(|axis| (at[axis] as usize).min(self.n[axis] - 1))
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (x * self.n[1] + y) * self.n[2] + z
    }

    fn nearest(&self, point: usize) -> f64 {
        let home = self.place(self.points[point]);
        let mut best = f64::INFINITY;
        let n_rings = self.n.into_iter().max().unwrap_or(1);
        for ring in 0..n_rings {
            // All points in ring k are at least k − 1 cells away, because the point can lie at the border of its own cell.
            if best <= (ring as f64 - 1.0) * self.cell {
                break;
            }
            self.each_in_ring(home, ring, |other| {
                if other != point {
                    let apart = (self.points[other] - self.points[point]).length();
                    best = best.min(apart);
                }
            });
        }
        best
    }

    /// Visits the points of all cells whose largest offset from the cell `home`, over the three axes, is `ring`.
    fn each_in_ring(&self, home: [usize; 3], ring: usize, mut visit: impl FnMut(usize)) {
        let range = |axis: usize| {
            home[axis].saturating_sub(ring)..=(home[axis] + ring).min(self.n[axis] - 1)
        };
        for x in range(0) {
            for y in range(1) {
                let inner = x.abs_diff(home[0]) < ring && y.abs_diff(home[1]) < ring;
                for z in range(2) {
                    if inner && z.abs_diff(home[2]) < ring {
                        continue;
                    }
                    let cell = self.index([x, y, z]);
                    for &other in &self.order[self.starts[cell]..self.starts[cell + 1]] {
                        visit(other);
                    }
                }
            }
        }
    }
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
            let points: Vec<DVec3> = (0..n)
                .map(|_| stretch * DVec3::new(rng.r#gen(), rng.r#gen::<f64>().powi(6), rng.r#gen()))
                .collect();
            let brute = |i: usize| {
                let others = (0..n).filter(|&j| j != i);
                others
                    .map(|j| (points[j] - points[i]).length())
                    .fold(f64::INFINITY, f64::min)
            };
            let expected: Vec<f64> = (0..n).map(brute).collect();
            assert_eq!(
                nearest_distances(&points),
                expected,
                "case {case}, {n} points"
            );
        }
    }

    #[test]
    fn corners_stored_twice_change_nothing() {
        let once: Vec<DVec3> = (0..20)
            .map(|i| DVec3::new(f64::from(i * i), 1.0, -0.0))
            .collect();
        let twice: Vec<DVec3> = once
            .iter()
            .flat_map(|&v| [v, DVec3::new(v.x, 1.0, 0.0)])
            .collect();
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
        let error = vertex_spheres("dot.ply", &[DVec3::ONE; 5])
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("dot.ply: all vertices at one place"),
            "{error}"
        );
    }
}
