//! Height of the centre of mass above a table for every direction of down: h(d) = max_j (c_j · d + r_j).
//!
//! The spheres c_j, r_j are relative to the centre of mass, and d is a unit vector. Directions are the corners of a subdivided icosahedron. Each
//! triangle stores only the spheres that can be highest somewhere inside it, so h takes a few dot products
//! and is still exact.

use crate::objects::Sphere;
use glam::DVec3;

/// Number of subdivisions of the mesh of directions, which gives 10,242 directions, 2.1° apart. One less halves the time and merges basins narrower than 8°;
/// one more takes four times as long.
const LEVELS: usize = 5;

/// Support function of a union of spheres about a point, with a mesh of directions for searches. The function is the height of the point above a table on
/// which the union lies.
pub(crate) struct Support {
    spheres: Vec<Sphere>,
    /// Unit vectors of the mesh of directions.
    pub directions: Vec<DVec3>,
    /// Height of the point above the table for each direction of the mesh, metres.
    pub heights: Vec<f64>,
    /// Triangles of the finest level of the mesh, as indices of directions. Triangle t of a level contains triangles 4t … 4t + 3 of the next level.
    pub triangles: Vec<[usize; 3]>,
    /// Triangles of every level of the mesh except the finest.
    coarse: Vec<Vec<[usize; 3]>>,
    /// Indices of the spheres that can determine the height inside each triangle of the last coarse level.
    candidates: Vec<Vec<u32>>,
}

impl Support {
    /// Creates the support function of spheres (radii zero or more) about a point in their frame, metres.
    pub fn about(point: DVec3, spheres: &[Sphere]) -> Self {
        let relative = |s: &Sphere| Sphere {
            center: s.center - point,
            radius: s.radius,
        };
        let (directions, mut levels) = subdivided_icosahedron();
        let triangles = levels.pop().unwrap_or_default();
        let mut support = Self {
            spheres: spheres.iter().map(relative).collect(),
            heights: vec![0.0; directions.len()],
            directions,
            triangles,
            coarse: levels,
            candidates: Vec::new(),
        };
        support.narrow_candidates();
        support.evaluate_mesh();
        support
    }

    /// Returns the distance of the union's farthest point from the point of this support function, metres.
    pub fn radius(&self) -> f64 {
        let reach = |s: &Sphere| s.center.length() + s.radius;
        self.spheres.iter().map(reach).fold(0.0, f64::max)
    }

    /// Returns the height of the centre of mass above the table if the unit vector `down` points at the table, metres.
    pub fn height(&self, down: DVec3) -> f64 {
        self.highest(self.cell_of(down), down)
    }

    /// Returns every sphere that can determine the height within about `reach` (radians) of the direction `down`.
    pub fn candidates_near(&self, down: DVec3, reach: f64) -> Vec<Sphere> {
        let (u, v) = down.any_orthonormal_pair();
        let ring = |reach: f64| {
            (0..8).map(move |k| {
                let (sin, cos) = (std::f64::consts::FRAC_PI_4 * f64::from(k)).sin_cos();
                self.cell_of((down + reach * (cos * u + sin * v)).normalize())
            })
        };
        let rings = ring(reach).chain(ring(0.5 * reach));
        let mut cells: Vec<_> = rings.chain([self.cell_of(down)]).collect();
        cells.sort_unstable();
        cells.dedup();
        let indices = cells.iter().flat_map(|&cell| &self.candidates[cell]);
        let mut indices: Vec<_> = indices.collect();
        indices.sort_unstable();
        indices.dedup();
        let sphere = |&&index: &&u32| self.spheres[index as usize];
        indices.iter().map(sphere).collect()
    }

    /// Returns the index of a mesh direction next to `direction`: the nearest corner of the finest triangle around it.
    pub fn nearest_direction(&self, direction: DVec3) -> usize {
        let cell = self.cell_of(direction);
        let corners = self.triangles[4 * cell..4 * cell + 4].iter().flatten();
        let near = |v: &usize| self.directions[*v].dot(direction);
        let nearest = corners.copied().max_by(|a, b| near(a).total_cmp(&near(b)));
        nearest.unwrap_or(0)
    }

    /// Returns the index of the triangle of the last coarse level that contains a direction.
    fn cell_of(&self, direction: DVec3) -> usize {
        let depths = |triangle: &[usize; 3]| {
            let [a, b, c] = triangle.map(|v| self.directions[v]);
            [(a, b), (b, c), (c, a)].map(|(from, to)| direction.dot(from.cross(to)))
        };
        let smallest = |depths: [f64; 3]| {
            let order = |a: &usize, b: &usize| depths[*a].total_cmp(&depths[*b]);
            let side = (0..3).min_by(order).unwrap_or(0);
            (side, depths[side])
        };
        let depth = |t: &usize| smallest(depths(&self.coarse[0][*t])).1;
        let faces = 0..self.coarse[0].len();
        let deepest = faces.max_by(|a, b| depth(a).total_cmp(&depth(b)));
        let mut cell = deepest.unwrap_or(0);
        for level in &self.coarse[1..] {
            // Child 3 is the middle one; beyond its sides 0, 1, 2 are the children at corners 1, 2, 0.
            let (side, depth) = smallest(depths(&level[4 * cell + 3]));
            let child = if depth >= 0.0 { 3 } else { (side + 1) % 3 };
            cell = 4 * cell + child;
        }
        cell
    }

    /// Returns the largest height that a candidate sphere of a coarse triangle requires in a direction, metres.
    fn highest(&self, cell: usize, direction: DVec3) -> f64 {
        let height = |&index: &u32| {
            let sphere = &self.spheres[index as usize];
            sphere.center.dot(direction) + sphere.radius
        };
        let heights = self.candidates[cell].iter().map(height);
        heights.fold(f64::NEG_INFINITY, f64::max)
    }

    fn narrow_candidates(&mut self) {
        let everything: Vec<u32> = (0..self.spheres.len() as u32).collect();
        let mut wide = Vec::new();
        for (depth, level) in self.coarse.iter().enumerate() {
            let narrow = |(t, corners): (usize, &[usize; 3])| {
                let candidates = if depth == 0 {
                    &everything
                } else {
                    &wide[t / 4]
                };
                let corners = corners.map(|v| self.directions[v]);
                not_dominated(&self.spheres, candidates, corners)
            };
            wide = level.iter().enumerate().map(narrow).collect();
        }
        self.candidates = wide;
    }

    fn evaluate_mesh(&mut self) {
        let mut known = vec![false; self.directions.len()];
        for (t, corners) in self.triangles.iter().enumerate() {
            for &vertex in corners {
                if !known[vertex] {
                    self.heights[vertex] = self.highest(t / 4, self.directions[vertex]);
                    known[vertex] = true;
                }
            }
        }
    }
}

/// Returns the candidate spheres that no other sphere dominates over a whole triangle of directions, given by its corners. The dominating sphere c* is one
/// that is highest at a corner.
///
/// Inside the triangle, d = v / |v| with v = Σ αᵢ vᵢ over the corners, αᵢ ≥ 0, Σ αᵢ = 1, and |v| from ϱ (the plane's distance) to 1. So (c − c*)·d + r − r* ≤ 0
/// everywhere if (c − c*)·vᵢ + max((r − r*) ϱ, r − r*) ≤ 0 at all three corners.
fn not_dominated(spheres: &[Sphere], candidates: &[u32], corners: [DVec3; 3]) -> Vec<u32> {
    let values: Vec<_> = candidates
        .iter()
        .map(|&index| {
            let sphere = &spheres[index as usize];
            (corners.map(|v| sphere.center.dot(v)), sphere.radius)
        })
        .collect();
    let [a, b, c] = corners;
    let plane = (b - a).cross(c - a).normalize().dot(a).abs();
    let leaders = [0, 1, 2].map(|corner| {
        let height = |place: usize| values[place].0[corner] + values[place].1;
        let highest = |a: &usize, b: &usize| height(*a).total_cmp(&height(*b));
        (0..values.len()).max_by(highest).unwrap_or(0)
    });
    let beaten = |(value, radius): &([f64; 3], f64)| {
        leaders.iter().any(|&leader| {
            let (leader, leader_radius) = values[leader];
            let larger = radius - leader_radius;
            let gain = larger.max(larger * plane);
            (0..3).all(|i| value[i] - leader[i] + gain <= 0.0)
        })
    };
    (0..values.len())
        .filter(|place| leaders.contains(place) || !beaten(&values[*place]))
        .map(|place| candidates[place])
        .collect()
}

/// Returns the unit directions of a subdivided icosahedron, and the triangles of each level, from the 20 faces to the finest level.
fn subdivided_icosahedron() -> (Vec<DVec3>, Vec<Vec<[usize; 3]>>) {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let mut directions = Vec::new();
    for (s, t) in [
        (-1.0, golden),
        (1.0, golden),
        (-1.0, -golden),
        (1.0, -golden),
    ] {
        directions.push(DVec3::new(s, t, 0.0).normalize());
        directions.push(DVec3::new(0.0, s, t).normalize());
        directions.push(DVec3::new(t, 0.0, s).normalize());
    }
    let mut levels = vec![icosahedron_faces(&directions)];
    for level in 0..LEVELS {
        // Later corners joined to each corner by an edge, and the middle of this edge.
        let mut middles: Vec<Vec<(usize, usize)>> = vec![Vec::new(); directions.len()];
        let mut finer = Vec::with_capacity(4 * levels[level].len());
        for &[a, b, c] in &levels[level] {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| {
                let known = &mut middles[from.min(to)];
                if let Some((_, middle)) = known.iter().find(|(end, _)| *end == from.max(to)) {
                    return *middle;
                }
                known.push((from.max(to), directions.len()));
                directions.push((directions[from] + directions[to]).normalize());
                directions.len() - 1
            });
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        levels.push(finer);
    }
    (directions, levels)
}

/// Returns the icosahedron's 20 faces, as triples of mutually nearest corners, counter-clockwise as seen from outside.
fn icosahedron_faces(corners: &[DVec3]) -> Vec<[usize; 3]> {
    // Neighbours are 63° apart, all other pairs at least 117°.
    let near = |a: usize, b: usize| corners[a].dot(corners[b]) > 0.0;
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let outward = corners[a].cross(corners[b]).dot(corners[c]) > 0.0;
                    faces.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objects::SphereUnion;
    use crate::random::Seed;
    use rand::Rng;

    #[test]
    fn the_pruned_height_is_the_maximum_over_all_spheres() {
        let mut rng = Seed::new(5).rng();
        let mut random = || rng.r#gen::<f64>() - 0.5;
        let spheres = (0..300)
            .map(|_| Sphere {
                center: DVec3::new(random(), 0.6 * random(), 0.2 * random()),
                radius: 0.02 + 0.15 * random().abs(),
            })
            .collect();
        let union = SphereUnion::new(spheres).unwrap();
        let support = Support::about(DVec3::ZERO, union.spheres());
        for _ in 0..2000 {
            let down = DVec3::new(random(), random(), random()).normalize();
            let all = union.spheres().iter();
            let all = all.map(|s| s.center.dot(down) + s.radius);
            assert_eq!(support.height(down), all.fold(f64::NEG_INFINITY, f64::max));
        }
    }

    #[test]
    fn the_mesh_of_directions_is_even_and_closed() {
        let (directions, levels) = subdivided_icosahedron();
        assert_eq!(directions.len(), 10_242);
        assert_eq!(levels.last().unwrap().len(), 20_480);
        for &[a, b, c] in levels.last().unwrap() {
            let [a, b, c] = [a, b, c].map(|v| directions[v]);
            assert!(a.cross(b).dot(c) > 0.0);
            assert!(a.angle_between(b) < 3f64.to_radians());
        }
    }
}
