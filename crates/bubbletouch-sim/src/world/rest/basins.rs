//! Basins of the support function: regions of down directions from which descent leads to one minimum.
//!
//! 1. On a mesh of directions, each direction flows to its lowest neighbour, which defines basins.
//! 2. Basins with a low barrier between them are merged, first by the barrier along the mesh. Each minimum is then refined, and the barrier
//!    is measured along a smooth path between two minima. The smooth path follows the valley of a lying can, which the mesh only
//!    approximates.

use super::descent::descend;
use super::support::Support;
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
    let mut merging = Merging::new(support);
    merging.merge(&passes, barrier);
    merging.descend_minima(support, &label);
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

/// Basins of directions while they are merged (union-find).
struct Merging {
    /// Parent of each label in the union-find structure: another label of the same basin. A root is its own parent.
    parent: Vec<usize>,
    /// Lowest direction and its height, metres, for each basin, stored at the label of the basin's root.
    minimum: Vec<(DVec3, f64)>,
}

impl Merging {
    /// Creates one basin for each direction of the mesh.
    fn new(support: &Support) -> Self {
        let pairs = support.directions.iter().zip(&support.heights);
        Self {
            parent: (0..support.directions.len()).collect(),
            minimum: pairs.map(|(&down, &height)| (down, height)).collect(),
        }
    }

    fn root(&mut self, mut label: usize) -> usize {
        while self.parent[label] != label {
            self.parent[label] = self.parent[self.parent[label]];
            label = self.parent[label];
        }
        label
    }

    /// Merges basins that a low barrier separates, in order of the barriers' heights. Two basins are merged if the pass between them is less than `barrier`
    /// (metres) above the higher of their minima.
    fn merge(&mut self, passes: &[Pass], barrier: f64) {
        let mut by_height: Vec<&Pass> = passes.iter().collect();
        by_height.sort_by(|a, b| a.height.total_cmp(&b.height));
        for pass in by_height {
            let (a, b) = (self.root(pass.labels.0), self.root(pass.labels.1));
            if pass.height - self.floor(a, b) < barrier {
                self.join(a, b);
            }
        }
    }

    /// Merges the basins of two labels; the lower minimum is kept.
    fn join(&mut self, a: usize, b: usize) {
        let (keep, drop) = if self.minimum[a].1 <= self.minimum[b].1 {
            (a, b)
        } else {
            (b, a)
        };
        self.parent[drop] = keep;
    }

    /// Returns the larger of the minimum heights of two basins, which are given by their roots.
    fn floor(&self, a: usize, b: usize) -> f64 {
        self.minimum[a].1.max(self.minimum[b].1)
    }

    /// Moves each basin's minimum from its mesh direction to the true local minimum. If a minimum ends among another basin's directions, the height never
    /// increased on the path to it, and the two basins are merged.
    fn descend_minima(&mut self, support: &Support, label: &[usize]) {
        let mut roots: Vec<_> = label.iter().map(|&label| self.root(label)).collect();
        roots.sort_unstable();
        roots.dedup();
        for &root in &roots {
            let down = descend(support, self.minimum[root].0);
            self.minimum[root] = (down, support.height(down));
        }
        for root in roots {
            let end = label[support.nearest_direction(self.minimum[root].0)];
            let (from, to) = (self.root(root), self.root(end));
            self.join(from, to);
        }
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
            let (a, b) = (self.root(pass.labels.0), self.root(pass.labels.1));
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
                area[self.root(label[corner])] += third;
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
