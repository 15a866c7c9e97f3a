//! Basins of the support function: regions of down directions from which descent leads to one minimum.
//!
//! 1. On a mesh of directions, each direction flows to its lowest neighbour, which defines basins.
//! 2. Each minimum is refined, because a corner of the mesh next to a sharp minimum is up to 2 % of the object's size higher. A minimum of the mesh that is
//!    not one of the function ends in another basin, and its basin is merged with a neighbour over the lowest pass.
//! 3. Basins with a low barrier between them are merged, first by the barrier along the mesh, then by the barrier along a smooth path between two minima. The
//!    smooth path follows the valley of a lying can, which the mesh only approximates.

use super::descent::descend;
use super::support::Support;
use crate::disjoint_sets::DisjointSets;
use glam::{DQuat, DVec3};

/// Spacing of the points on a path at which the height is computed, radians: a quarter of the spacing of the mesh of directions.
const PATH_SPACING: f64 = 0.01;
/// Maximum number of times that a path between two minima is halved so that it follows a bent valley; 4 suffices for a quarter circle.
const VALLEY_HALVINGS: usize = 4;
/// Angle below which two minima count as equal, radians: half the spacing of the mesh of directions.
const SAME_DIRECTION: f64 = 0.02;

/// Basin: a minimum of the support function, and the fraction of directions from which a rolling object ends there.
pub(crate) struct Basin {
    /// Direction, in the object's frame, that points down at the minimum; unit vector.
    pub lowest: DVec3,
    /// Fraction of all directions that lead to this minimum, 0 to 1; accurate to about 0.01.
    pub share: f64,
}

/// Returns all basins that are separated by barriers of at least `barrier` (metres), in the order of the mesh of directions.
pub(crate) fn basins(support: &Support, barrier: f64) -> Vec<Basin> {
    let label = downhill_labels(support);
    let passes = mesh_passes(support, &label);
    let mut merging = Merging::new(support, &label);
    merging.merge(&passes, barrier);
    for halvings in [0, VALLEY_HALVINGS] {
        let smooth = merging.smooth_passes(support, &passes, barrier, halvings);
        merging.merge(&smooth, barrier);
    }
    merging.basins(support, &label)
}

/// Pass: the lowest path between two basins, given by the basins' labels and the height of the path's highest point.
struct Pass {
    labels: (usize, usize),
    height: f64,
}

/// Returns the label of each direction of the mesh, which is the direction reached by repeatedly moving to the lowest neighbour.
fn downhill_labels(support: &Support) -> Vec<usize> {
    let heights = &support.heights;
    // Between equal heights the smaller index counts as lower, so that flat regions have an end.
    let lower = |a: usize, b: usize| (heights[a], a) < (heights[b], b);
    let mut next: Vec<usize> = (0..heights.len()).collect();
    for (a, b) in edges(support) {
        if lower(b, next[a]) {
            next[a] = b;
        }
    }
    let mut order: Vec<usize> = (0..heights.len()).collect();
    order.sort_unstable_by(|&a, &b| heights[a].total_cmp(&heights[b]).then(a.cmp(&b)));
    let mut label: Vec<usize> = (0..heights.len()).collect();
    for vertex in order {
        label[vertex] = label[next[vertex]];
    }
    label
}

/// Returns the sides of all triangles of the mesh of directions, so that every edge occurs twice, once in either direction.
fn edges(support: &Support) -> impl Iterator<Item = (usize, usize)> + '_ {
    let sides = |&[a, b, c]: &[usize; 3]| [(a, b), (b, c), (c, a)];
    support.triangles.iter().flat_map(sides)
}

/// Returns the lowest mesh edge between each pair of neighbouring labels, as passes.
fn mesh_passes(support: &Support, label: &[usize]) -> Vec<Pass> {
    let between = edges(support).filter(|&(a, b)| label[a] < label[b]);
    let pass = |(a, b): (usize, usize)| Pass {
        labels: (label[a], label[b]),
        height: support.heights[a].max(support.heights[b]),
    };
    lowest_of_each(between.map(pass).collect())
}

/// Returns only the lowest pass between each pair of labels.
fn lowest_of_each(mut passes: Vec<Pass>) -> Vec<Pass> {
    passes.sort_by(|a, b| {
        let by_height = a.height.total_cmp(&b.height);
        a.labels.cmp(&b.labels).then(by_height)
    });
    passes.dedup_by_key(|pass| pass.labels);
    passes
}

/// Basins of directions while they are merged.
struct Merging {
    /// Labels of each basin.
    joined: DisjointSets,
    /// Lowest direction and its height, metres, for each basin, stored at the label of the basin's root.
    minimum: Vec<(DVec3, f64)>,
    /// Whether the minimum of each basin is one of the function, and not only of the mesh, stored at the label of the basin's root.
    is_real: Vec<bool>,
}

impl Merging {
    /// Creates one basin for each label; the minima are refined from the mesh directions to the true local minima.
    fn new(support: &Support, label: &[usize]) -> Self {
        let pairs = support.directions.iter().zip(&support.heights);
        let mut minimum: Vec<(DVec3, f64)> = pairs.map(|(&down, &height)| (down, height)).collect();
        let mut is_real = vec![false; label.len()];
        for own in (0..label.len()).filter(|&own| label[own] == own) {
            let down = descend(support, minimum[own].0);
            is_real[own] = label[support.nearest_direction(down)] == own;
            if is_real[own] {
                minimum[own] = (down, support.height(down));
            }
        }
        Self {
            joined: DisjointSets::new(label.len()),
            minimum,
            is_real,
        }
    }

    /// Returns the roots of the two basins of a pass.
    fn roots(&mut self, pass: &Pass) -> (usize, usize) {
        let (a, b) = pass.labels;
        (self.joined.root(a), self.joined.root(b))
    }

    /// Merges basins that a low barrier separates, in order of the barriers' heights. Two basins are merged if the pass between them is less than `barrier`
    /// (metres) above the higher of their minima, or if one of the minima is not real.
    fn merge(&mut self, passes: &[Pass], barrier: f64) {
        let mut by_height: Vec<&Pass> = passes.iter().collect();
        by_height.sort_by(|a, b| a.height.total_cmp(&b.height));
        for pass in by_height {
            let (a, b) = self.roots(pass);
            let are_real = self.is_real[a] && self.is_real[b];
            if !are_real || pass.height - self.floor(a, b) < barrier {
                self.join(a, b);
            }
        }
    }

    /// Merges the basins of two roots; the lower minimum is kept, or the real one if only one is real.
    fn join(&mut self, a: usize, b: usize) {
        let rank = |root: usize| (!self.is_real[root], self.minimum[root].1);
        let (keep, drop) = if rank(a) <= rank(b) { (a, b) } else { (b, a) };
        self.joined.put_below(keep, drop);
    }

    /// Returns the larger of the minimum heights of two basins, which are given by their roots.
    fn floor(&self, a: usize, b: usize) -> f64 {
        self.minimum[a].1.max(self.minimum[b].1)
    }

    /// Returns the passes between the remaining basins: paths along the mesh, or smooth paths where these are lower.
    fn smooth_passes(
        &mut self,
        support: &Support,
        mesh: &[Pass],
        barrier: f64,
        halvings: usize,
    ) -> Vec<Pass> {
        let mut left = Vec::new();
        for pass in mesh {
            let (a, b) = self.roots(pass);
            if a != b {
                left.push(Pass {
                    labels: (a.min(b), a.max(b)),
                    height: pass.height,
                });
            }
        }
        let mut left = lowest_of_each(left);
        for pass in &mut left {
            let (a, b) = pass.labels;
            let ends = (self.minimum[a].0, self.minimum[b].0);
            let enough = self.floor(a, b) + barrier;
            let smooth = valley_pass(support, ends, enough, halvings);
            pass.height = pass.height.min(smooth);
        }
        left
    }

    /// Returns the remaining basins, each with its fraction of all directions.
    fn basins(mut self, support: &Support, label: &[usize]) -> Vec<Basin> {
        let mut area = vec![0.0; label.len()];
        for corners in &support.triangles {
            let [a, b, c] = corners.map(|v| support.directions[v]);
            let third = (b - a).cross(c - a).length() / 6.0;
            for &corner in corners {
                area[self.joined.root(label[corner])] += third;
            }
        }
        let total: f64 = area.iter().sum();
        let roots = area.iter().zip(&self.minimum).filter(|(a, _)| **a > 0.0);
        roots
            .map(|(area, minimum)| Basin {
                lowest: minimum.0,
                share: area / total,
            })
            .collect()
    }
}

/// Returns the height of the highest point of a path between two minima, metres. The path is the great circle if it stays below `enough`. Otherwise the path
/// leads through the minimum below its middle, which bends the path into the curved valley of a lying cone.
fn valley_pass(support: &Support, ends: (DVec3, DVec3), enough: f64, halvings: usize) -> f64 {
    let (from, to) = ends;
    let direct = highest_between(support, from, to);
    if halvings == 0 || direct < enough {
        return direct;
    }
    let middle = descend(support, (from + to).normalize_or(from));
    let arrived = |end: DVec3| end.angle_between(middle) < SAME_DIRECTION;
    if arrived(from) || arrived(to) {
        return direct;
    }
    let halves = [(from, middle), (middle, to)];
    let passes = halves.map(|ends| valley_pass(support, ends, enough, halvings - 1));
    direct.min(passes[0].max(passes[1]))
}

/// Returns the largest height along the shorter great circle between two directions, metres.
fn highest_between(support: &Support, from: DVec3, to: DVec3) -> f64 {
    let turn = DQuat::from_rotation_arc(from, to);
    let steps = (from.angle_between(to) / PATH_SPACING).ceil().max(1.0);
    (0..=steps as usize)
        .map(|i| DQuat::IDENTITY.slerp(turn, i as f64 / steps) * from)
        .map(|down| support.height(down.normalize()))
        .fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objects::Sphere;
    use crate::random::Seed;
    use crate::world::fixtures::vector;
    use rand::Rng;

    /// Returns the faces of the convex hull of points around the origin: corners, counter-clockwise from outside, and outward unit normals.
    fn hull(points: &[DVec3]) -> Vec<([DVec3; 3], DVec3)> {
        let mut faces = Vec::new();
        for (i, &a) in points.iter().enumerate() {
            for (j, &b) in points.iter().enumerate().skip(i + 1) {
                for &c in &points[j + 1..] {
                    let normal = (b - a).cross(c - a).normalize();
                    let side = normal.dot(a).signum();
                    if points.iter().all(|p| side * normal.dot(*p - a) < 1e-9) {
                        let corners = if side > 0.0 { [a, b, c] } else { [a, c, b] };
                        faces.push((corners, side * normal));
                    }
                }
            }
        }
        faces
    }

    #[test]
    fn no_stable_face_of_a_polyhedron_is_lost() {
        const BARRIER: f64 = 0.01;
        let (mut n_stable, mut n_low) = (0, 0);
        for case in 0..60 {
            let mut rng = Seed::new(3).named("polyhedra").numbered(case).rng();
            let points: Vec<DVec3> = (0..14)
                .map(|_| {
                    let point = vector(&mut rng);
                    point.normalize() * rng.gen_range(0.85..1.15)
                })
                .collect();
            let faces = hull(&points);
            let is_deep = |(corners, normal): &([DVec3; 3], DVec3)| normal.dot(corners[0]) >= 0.3;
            if !faces.iter().all(is_deep) {
                continue;
            }
            let radius = 0.0;
            let corners = points.iter().map(|&center| Sphere { center, radius });
            let support = Support::about(DVec3::ZERO, &corners.collect::<Vec<_>>());
            let size = support.radius();
            let found = basins(&support, BARRIER * size);
            for (corners, normal) in &faces {
                let height = normal.dot(corners[0]);
                // Lowest pass over an edge of the face, and the smallest angle to it.
                let (mut pass, mut angle) = (f64::INFINITY, f64::INFINITY);
                for k in 0..3 {
                    let [from, to] = [corners[k], corners[(k + 1) % 3]];
                    let along = (to - from).normalize();
                    let foot = from - from.dot(along) * along;
                    let is_inside = normal.cross(along).dot(from) < 0.0;
                    if !is_inside {
                        pass = f64::NEG_INFINITY;
                        break;
                    }
                    let beyond = faces.iter().find(|(other, n)| {
                        n != normal && other.contains(&from) && other.contains(&to)
                    });
                    let (_, beyond) = beyond.expect("an edge has two faces");
                    let [over, next] =
                        [foot.normalize(), *beyond].map(|down| normal.angle_between(down));
                    pass = pass.min(match over < next {
                        true => foot.length(),
                        false => beyond.dot(from),
                    });
                    angle = angle.min(over.min(next));
                }
                let rise = (pass - height) / size;
                if rise > 1.02 * BARRIER && angle > 0.07 {
                    n_stable += 1;
                    n_low += usize::from(rise < 2.0 * BARRIER);
                    let apart = |basin: &Basin| basin.lowest.angle_between(*normal);
                    let is_found = found.iter().any(|basin| apart(basin) < 1e-3);
                    assert!(is_found, "{case}: barrier of {rise}");
                }
            }
        }
        assert!(n_stable > 100 && n_low > 10, "{n_stable} {n_low}");
    }
}
