//! The poses in which an object rests on a table, exactly from its spheres.
//!
//! With d the direction of down in the object's frame, the centre of mass stands h(d) = max_j (c_j · d + r_j) above the table
//! (c_j relative to it). An object that is tipped slowly rolls downhill on h over the sphere of directions: it rests in the
//! local minima. The chance of a minimum is the share of directions that roll into it, as if the object were put
//! down in a random orientation (quasi-static toppling; Goldberg, Mirtich, Zhuang, Craig, Carlisle, Canny, *Part pose
//! statistics*, 1999).
//!
//! 1. On a mesh of directions, each flows to its lowest neighbour: basins.
//! 2. Basins with a low barrier between them are one: first the barrier along the mesh; then, with each minimum found exactly,
//!    the barrier along a smooth path between two minima, which follows the valley of a lying can where the mesh hops across
//!    it.

use super::mass::center_of_mass;
use super::settle::settle;
use super::support::Support;
use crate::geometry::Pose;
use crate::objects::SphereUnion;
use glam::{DQuat, DVec3};
use std::collections::BTreeMap;

/// The least barrier between two poses, as a share of the farthest point's distance. Smaller: the bumps of spheres on a round
/// side become poses. Larger: poses that need a firm push to leave are lost (1 % keeps all that stand ± 8°).
const BARRIER: f64 = 0.01;
/// The least probability of a pose. Smaller: more poses that hardly occur.
const LEAST_PROBABILITY: f64 = 0.02;
/// Heights taken along the great circle between two minima.
const PATH_SAMPLES: usize = 64;

/// How often a path between two minima may be halved to follow a bent valley; 4 follows a quarter circle.
const VALLEY_HALVINGS: usize = 4;
/// Minima closer than this are the same, radians: half the spacing of the mesh.
const SAME_DIRECTION: f64 = 0.02;

/// A pose in which an object rests on the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestPose {
    /// Rests on z = 0, z up, the box around its spheres centred at x = y = 0.
    pub table_from_object: Pose,
    /// z of the object's top, metres.
    pub height: f64,
    /// How likely among the object's poses, above 0; they sum to 1.
    pub probability: f64,
}

/// The pose with the object's own z up.
pub fn as_modelled(spheres: &SphereUnion) -> RestPose {
    resting(spheres, DVec3::NEG_Z, 1.0)
}

/// The poses in which the union, as a homogeneous solid ([`center_of_mass`]), rests on a table, likeliest first; at least one.
///
/// A round object that rolls has one pose for all the directions it rolls through. Poses less likely than 2 % are left
/// out. About 20 ms for 3,000 spheres.
pub fn stable_poses(spheres: &SphereUnion) -> Vec<RestPose> {
    stable_poses_about(spheres, center_of_mass(spheres))
}

/// [`stable_poses`] with a given centre of mass, metres, in the union's frame.
pub fn stable_poses_about(spheres: &SphereUnion, center_of_mass: DVec3) -> Vec<RestPose> {
    let support = Support::about(center_of_mass, spheres);
    let barrier = BARRIER * support.radius();
    let label = downhill_labels(&support);
    let mut basins = Basins::at(&support, &label);
    basins.merge(mesh_passes(&support, &label), barrier);
    basins.settle(&support, &label);
    let passes = basins.valley_passes(&support, mesh_passes(&support, &label), barrier);
    basins.merge(passes, barrier);
    let mut poses: Vec<_> = basins
        .probabilities(&support, &label)
        .into_iter()
        .map(|(root, probability)| resting(spheres, basins.minimum[&root].0, probability))
        .collect();
    poses.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let least = LEAST_PROBABILITY.min(poses[0].probability);
    poses.retain(|pose| pose.probability >= least);
    let total: f64 = poses.iter().map(|pose| pose.probability).sum();
    for pose in &mut poses {
        pose.probability /= total;
    }
    poses
}

/// The pose with `down` (unit, object frame) pointing at the table, by the shortest turn from upright or upside-down.
fn resting(spheres: &SphereUnion, down: DVec3, probability: f64) -> RestPose {
    let upside_down = DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0);
    let rotation = if down.z <= 0.0 {
        DQuat::from_rotation_arc(down, DVec3::NEG_Z)
    } else {
        upside_down * DQuat::from_rotation_arc(down, DVec3::Z)
    };
    let bounds = spheres.moved(&Pose::from_rotation(rotation)).bounds();
    let middle = bounds.center();
    RestPose {
        table_from_object: Pose::new(rotation, DVec3::new(-middle.x, -middle.y, -bounds.min.z)),
        height: bounds.size().z,
        probability,
    }
}

/// For each direction of the mesh, the lowest one that it reaches by always going to its lowest neighbour.
fn downhill_labels(support: &Support) -> Vec<usize> {
    let heights = &support.heights;
    // Equal heights flow to the smaller index, so that flats have an end.
    let lower = |a: usize, b: usize| (heights[a], a) < (heights[b], b);
    let mut next: Vec<usize> = (0..heights.len()).collect();
    for (a, b) in edges(support) {
        for (from, to) in [(a, b), (b, a)] {
            if lower(to, next[from]) {
                next[from] = to;
            }
        }
    }
    let mut order: Vec<usize> = (0..heights.len()).collect();
    order.sort_unstable_by(|&a, &b| heights[a].total_cmp(&heights[b]).then(a.cmp(&b)));
    let mut label = vec![0; heights.len()];
    for vertex in order {
        label[vertex] = if next[vertex] == vertex {
            vertex
        } else {
            label[next[vertex]]
        };
    }
    label
}

/// Each side of each triangle; every edge of the mesh comes twice, once from either side.
fn edges(support: &Support) -> impl Iterator<Item = (usize, usize)> + '_ {
    let sides = |&[a, b, c]: &[usize; 3]| [(a, b), (b, c), (c, a)];
    support.triangles.iter().flat_map(sides)
}

/// The lowest mesh edge between each two neighbouring basins.
fn mesh_passes(support: &Support, label: &[usize]) -> Passes {
    let mut passes = Passes::new();
    for (a, b) in edges(support) {
        if label[a] < label[b] {
            let height = support.heights[a].max(support.heights[b]);
            let pass = passes.entry((label[a], label[b])).or_insert(height);
            *pass = pass.min(height);
        }
    }
    passes
}

/// The height of the pass between two basins, by their labels.
type Passes = BTreeMap<(usize, usize), f64>;

/// Basins that merge as barriers are levelled.
struct Basins {
    /// Label → another label of the same basin, up to the root.
    parent: BTreeMap<usize, usize>,
    /// Root → its lowest direction and height.
    minimum: BTreeMap<usize, (DVec3, f64)>,
}

impl Basins {
    fn at(support: &Support, label: &[usize]) -> Self {
        let parent: BTreeMap<_, _> = label.iter().map(|&l| (l, l)).collect();
        let lowest = |&l: &usize| (l, (support.directions[l], support.heights[l]));
        let minimum = parent.keys().map(lowest).collect();
        Self { parent, minimum }
    }

    fn root(&self, mut label: usize) -> usize {
        while self.parent[&label] != label {
            label = self.parent[&label];
        }
        label
    }

    /// Levels barriers, lowest pass first: two basins become one if the pass stands less than `barrier` above the higher of
    /// their minima.
    fn merge(&mut self, passes: Passes, barrier: f64) {
        let mut passes: Vec<_> = passes.into_iter().collect();
        passes.sort_by(|a, b| a.1.total_cmp(&b.1));
        for ((a, b), pass) in passes {
            let (a, b) = (self.root(a), self.root(b));
            if a == b || pass - self.minimum[&a].1.max(self.minimum[&b].1) >= barrier {
                continue;
            }
            let (keep, drop) = if self.minimum[&a].1 <= self.minimum[&b].1 {
                (a, b)
            } else {
                (b, a)
            };
            self.parent.insert(drop, keep);
            self.minimum.remove(&drop);
        }
    }

    /// Moves each minimum from its mesh direction to the true local minimum. One that ends in another basin's directions has
    /// rolled there without a rise: the two are one.
    fn settle(&mut self, support: &Support, label: &[usize]) {
        for (down, height) in self.minimum.values_mut() {
            *down = settle(support, *down);
            *height = support.height(*down);
        }
        let ends: Vec<_> = self.minimum.iter().map(|(&r, &(d, h))| (r, d, h)).collect();
        let mut rolled = Passes::new();
        for (root, down, height) in ends {
            let end = self.root(label[support.nearest_direction(down)]);
            let other = self.minimum[&end].1;
            rolled.insert((root, end), height.max(other));
        }
        self.merge(rolled, f64::MIN_POSITIVE);
    }

    /// The passes between what is left of the basins: the mesh's, or the valley's between the two minima where that is lower.
    fn valley_passes(&self, support: &Support, mesh: Passes, barrier: f64) -> Passes {
        let mut passes = Passes::new();
        for ((a, b), height) in mesh {
            let (a, b) = (self.root(a), self.root(b));
            if a != b {
                let pass = passes.entry((a.min(b), a.max(b))).or_insert(height);
                *pass = pass.min(height);
            }
        }
        for (&(a, b), pass) in &mut passes {
            let ends = (self.minimum[&a].0, self.minimum[&b].0);
            *pass = pass.min(valley_pass(support, ends, barrier, VALLEY_HALVINGS));
        }
        passes
    }

    /// Each root's share of the sphere of directions.
    fn probabilities(&self, support: &Support, label: &[usize]) -> BTreeMap<usize, f64> {
        let mut share = BTreeMap::new();
        let mut total = 0.0;
        for corners in &support.triangles {
            let [a, b, c] = corners.map(|v| support.directions[v]);
            let third = (b - a).cross(c - a).length() / 6.0;
            for &corner in corners {
                *share.entry(self.root(label[corner])).or_insert(0.0) += third;
                total += third;
            }
        }
        share.values_mut().for_each(|share| *share /= total);
        share
    }
}

/// The highest point of a path between two minima: the great circle if it stays below the barrier; else it is led through
/// the minimum that its middle rolls to, which bends it into the curved valley of a lying cone.
fn valley_pass(support: &Support, ends: (DVec3, DVec3), barrier: f64, halvings: usize) -> f64 {
    let (from, to) = ends;
    let direct = highest_between(support, from, to);
    let floor = support.height(from).max(support.height(to));
    if halvings == 0 || direct < floor + barrier {
        return direct;
    }
    let middle = settle(support, (from + to).normalize_or(from));
    let arrived = |end: DVec3| end.angle_between(middle) < SAME_DIRECTION;
    if arrived(from) || arrived(to) {
        return direct;
    }
    let halves = [(from, middle), (middle, to)];
    let passes = halves.map(|ends| valley_pass(support, ends, barrier, halvings - 1));
    direct.min(passes[0].max(passes[1]))
}

/// The highest of the heights along the shorter great circle between two directions.
fn highest_between(support: &Support, from: DVec3, to: DVec3) -> f64 {
    let turn = DQuat::from_rotation_arc(from, to);
    (0..=PATH_SAMPLES)
        .map(|i| DQuat::IDENTITY.slerp(turn, i as f64 / PATH_SAMPLES as f64) * from)
        .map(|down| support.height(down.normalize()))
        .fold(f64::NEG_INFINITY, f64::max)
}
