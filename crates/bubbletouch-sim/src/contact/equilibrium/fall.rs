//! Free fall and sliding: the distance that unsupported bodies can safely move before they meet an obstacle.

use super::body::Body;
use super::free_object::Ground;
use super::pair::Key;
use super::pairs::Pairs;
use super::rigid_contact::Touched;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Slope of the energy, relative to the weight, below which planes support a body. The value is well below the accepted imbalance of a pose at rest.
const FLAT: f64 = 1e-8;

/// Group of unsupported bodies: they touch only one another and planes, but no skin and no obstacle.
#[derive(Clone, Debug, Default)]
pub(super) struct Loose {
    pub bodies: Vec<usize>,
    planes: BTreeSet<usize>,
    is_held: bool,
}

impl Loose {
    /// Returns all groups of bodies that no skin or obstacle supports, and the unions of such groups. `pairs` are the contacts of the `n_bodies` bodies.
    pub fn all(pairs: &Pairs, n_bodies: usize) -> Vec<Self> {
        let islands = pairs.islands(n_bodies);
        let mut all = vec![Self::default(); n_bodies];
        for (body, &island) in islands.iter().enumerate() {
            all[island].bodies.push(body);
        }
        for pair in &pairs.all {
            for (body, ..) in pair.ends() {
                let group = &mut all[islands[body]];
                match pair.key {
                    Key::Rigid(_, Touched::Object(..)) => {}
                    Key::Rigid(_, Touched::Plane(plane)) => {
                        group.planes.insert(plane);
                    }
                    _ => group.is_held = true,
                }
            }
        }
        all.retain(|group| !group.bodies.is_empty() && !group.is_held);
        // As a last resort, groups on equal planes are also moved together: side by side, groups can block one another forever.
        let mut unions: BTreeMap<BTreeSet<usize>, Vec<usize>> = BTreeMap::new();
        for group in &all {
            let union = unions.entry(group.planes.clone()).or_default();
            union.extend(&group.bodies);
        }
        all.extend(unions.into_iter().map(|(planes, mut bodies)| {
            bodies.sort_unstable();
            Self {
                bodies,
                planes,
                is_held: false,
            }
        }));
        all
    }

    /// Returns the direction of the group's motion under gravity (unit vector): the vector `down`, constrained by the planes that the group touches. Returns
    /// `None` if the planes support the group.
    pub fn direction(&self, ground: &Ground, down: DVec3) -> Option<DVec3> {
        let normals = self.planes.iter().map(|&plane| ground.planes[plane].normal);
        let normals: Vec<DVec3> = normals.collect();
        // Candidates are `down` and its projections onto planes and onto the lines where two planes meet. The longest candidate that enters no plane is the
        // constrained direction.
        let along_one = normals
            .iter()
            .map(|normal| down.reject_from_normalized(*normal));
        let along_two = normals.iter().enumerate().flat_map(|(k, one)| {
            let lines = normals[..k].iter().map(|other| one.cross(*other));
            lines
                .filter_map(DVec3::try_normalize)
                .map(|line| down.project_onto_normalized(line))
        });
        let all = std::iter::once(down).chain(along_one).chain(along_two);
        let outside = all.filter(|way| normals.iter().all(|normal| way.dot(*normal) >= -FLAT));
        let way = outside.max_by(|a, b| a.length().total_cmp(&b.length()))?;
        (way.length() > FLAT).then(|| way.normalize())
    }

    /// Returns a lower bound, metres, of the distance along `way` (unit vector) that the group can move without contact. The bound considers skins,
    /// obstacles, the other bodies, and planes that the group does not touch. The bound is infinite if nothing lies in this direction; `None` if something is
    /// too near to decide.
    pub fn clearance(&self, bodies: &[Body], ground: &Ground, way: DVec3) -> Option<f64> {
        let others = bodies.iter().enumerate();
        let others = others.filter(|(other, _)| !self.bodies.contains(other));
        let others: Vec<&Body> = others.map(|other| other.1).collect();
        let each = self.bodies.iter();
        let gaps = each.map(|&body| self.gap(&bodies[body], ground, &others, way));
        let nearest = gaps.fold(f64::INFINITY, f64::min);
        (nearest > 0.0).then_some(nearest)
    }

    /// Returns whether the group touches a plane and thus slides on it.
    pub fn slides(&self) -> bool {
        !self.planes.is_empty()
    }

    /// Returns the distance that one body of the group can move along `way` before it meets another object, metres.
    fn gap(&self, body: &Body, ground: &Ground, others: &[&Body], way: DVec3) -> f64 {
        let mut nearest = f64::INFINITY;
        let mut meet = |gap: f64, is_on_way: bool| {
            if gap <= 0.0 || is_on_way {
                nearest = nearest.min(gap);
            }
        };
        for skin in &ground.skins {
            let Some(bounds) = skin.patch.tree().bounds() else {
                continue;
            };
            let to_patch = skin.world_from_patch.inverse();
            let center = to_patch.transform_point(body.center);
            let reach = body.arm() + skin.patch.tree().largest_radius();
            let entry = bounds
                .widened(reach)
                .entry(center, to_patch.transform_vector(way), 0.0);
            meet(
                bounds.distance_squared(center).sqrt() - reach,
                entry.is_finite(),
            );
        }
        for (number, plane) in ground.planes.iter().enumerate() {
            if !self.planes.contains(&number) {
                let gap = body.center.dot(plane.normal) - plane.height - body.arm();
                meet(gap, way.dot(plane.normal) < 0.0);
            }
        }
        let obstacles = ground.obstacles.iter().map(|obstacle| {
            let center = obstacle.shape.bounds().center();
            let radius = obstacle.shape.reach_from(center);
            (obstacle.pose.transform_point(center), radius)
        });
        let others = others.iter().map(|other| (other.center, other.arm()));
        for (center, radius) in obstacles.chain(others) {
            let (to, reach) = (center - body.center, radius + body.arm());
            let is_beside = to.reject_from_normalized(way).length() >= reach;
            meet(to.length() - reach, !is_beside && to.dot(way) > 0.0);
        }
        nearest
    }
}
