//! Elastic energy of the skins that free objects press at their present poses, and the resulting forces.

use super::body::Body;
use super::free_object::PlacedSkin;
use super::loads::{Load, Loads};
use super::meshes::Depth;
use super::pair::{Key, Pair, Part};
use super::pairs::{Group, Margins, Pairs};
use super::scene::Scene;
use super::shear_springs::{self, Spring};
use glam::DVec3;

/// Weight of the violation of rigid contacts in the complementarity residual, 1/m.
const RIGID_MISS: f64 = 1e-7 / 3e-10;

/// Energy at the present poses of all bodies, with the contacts and loads from which the quadratic model is built.
#[derive(Clone, Debug, Default)]
pub(super) struct Energy {
    pub pairs: Pairs,
    pub loads: Loads,
}

/// Load of one pair; a pair is a sphere with the taxel or rigid counterpart that it pushes.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairLoad {
    /// Index of the pair (sphere and taxel or rigid counterpart) in the list of all pairs.
    pub pair: usize,
    /// Force on the sphere along the taxel's axis, newtons, including the force at the end of the taxel's stroke.
    pub force: f64,
    /// Part of the force, newtons, that the hard limit at the end of the taxel's stroke carries.
    pub stop: f64,
}

impl Energy {
    /// Evaluates the energy at the present poses of the bodies, and collects all contacts that can occur after a motion of at most `step` metres. `depth` are the
    /// penetrations of rigid meshes. `before` lists the spheres that were behind a taxel's substrate at the previous poses, and the rigid contacts that are held.
    pub fn look(
        &mut self,
        scene: &Scene,
        (step, depth): (f64, Depth),
        before: (&[(Key, Part)], &[Key]),
    ) {
        let margins = Margins {
            step,
            window: 2.0 * scene.smoothness.smoothing + 4.0 * step,
            depth,
        };
        self.pairs
            .look(&scene.bodies, scene.ground, margins, before);
        self.loads.weigh(
            (&scene.multipliers, &scene.smoothness),
            &self.pairs,
            |(_, pair)| pair.deflection,
        );
        self.loads.elastic += shear_springs::energy(&scene.springs, &scene.bodies);
    }

    /// Returns the load of each pair of a sphere and a taxel or rigid counterpart. Each taxel carries its stiffness times its deflection, plus the force at
    /// the end of its stroke.
    pub fn pair_loads(&self) -> Vec<PairLoad> {
        let mut all = Vec::new();
        for (group, load) in self.loads.carrying(&self.pairs.groups) {
            let force = group.stiffness * load.deepest.clamp(0.0, group.stroke) + load.stop;
            let sharing = group.pairs.clone().map(|at| (at, self.loads.shares[at]));
            let sharing = sharing.filter(|(_, share)| *share > 0.0);
            all.extend(sharing.map(|(pair, share)| PairLoad {
                pair,
                force: share * force,
                stop: share * load.stop,
            }));
        }
        all
    }

    /// Returns the complementarity residual of each island (group of bodies in contact), dimensionless; 0 for an island without contacts.
    ///
    /// At a solution, spheres that share a taxel push it equally far, and no taxel is deflected beyond its stroke. A taxel whose hard limit carries load is
    /// deflected exactly by its stroke. The residual is the taxel's stiffness times the largest violation of these conditions, divided by the largest force
    /// of a spring. For rigid contacts the stiffness is replaced by the constant [`RIGID_MISS`].
    pub fn complementarity_residual(&self, islands: &[usize]) -> Vec<f64> {
        let (mut loose, mut largest) = (vec![0.0_f64; islands.len()], vec![0.0_f64; islands.len()]);
        let mut rigid = loose.clone();
        for (group, load) in self.pairs.groups.iter().zip(&self.loads.all) {
            let mut ends = self.pairs.all[group.pairs.clone()]
                .iter()
                .flat_map(Pair::ends);
            let Some((body, ..)) = ends.next() else {
                continue;
            };
            let island = islands[body];
            let miss = self.miss(group, load);
            if let Key::Rigid(..) = group.key {
                rigid[island] = rigid[island].max(RIGID_MISS * miss);
            } else {
                loose[island] = loose[island].max(group.stiffness * miss);
                largest[island] = largest[island].max(group.stiffness * load.deepest);
            }
        }
        for (island, rigid) in rigid.into_iter().enumerate() {
            let largest = largest[island].max(f64::MIN_POSITIVE);
            loose[island] = rigid.max(loose[island] / largest);
        }
        loose
    }

    /// Returns the constraint violation of one taxel or rigid contact, metres, from which the complementarity residual is computed.
    fn miss(&self, group: &Group, load: &Load) -> f64 {
        let past = load.deepest - group.stroke;
        let of_stop: f64 = if load.stop > 0.0 { past.abs() } else { past };
        if load.force == 0.0 {
            // The taxel is pressed, but lies below the smoothed maximum, which uses the shares of an earlier pose.
            return of_stop.max(load.deepest);
        }
        let sharing = group
            .pairs
            .clone()
            .filter(|&at| self.loads.shares[at] > 1e-9);
        let apart = sharing.map(|at| load.deepest - self.pairs.all[at].deflection);
        apart.fold(of_stop, f64::max)
    }
}

/// Returns for each body the force (N) and the torque about its centre of mass (N·m), in the world frame. Force and torque are sums over all contacts and
/// tangential springs.
pub(super) fn wrenches(
    (loads, pairs): (&[PairLoad], &[Pair]),
    springs: &[Spring],
    bodies: &[Body],
    skins: &[PlacedSkin],
) -> Vec<(DVec3, DVec3)> {
    let mut all = vec![(DVec3::ZERO, DVec3::ZERO); bodies.len()];
    for load in loads {
        let pair = &pairs[load.pair];
        let push = pair.push(load.force);
        let to_world = |v: DVec3| match pair.key {
            Key::Taxel(skin, _) => skins[skin as usize].world_from_patch.rotation * v,
            Key::Rigid(..) => v,
        };
        for (body, sign, arm) in pair.ends() {
            all[body].0 += to_world(sign * push);
            all[body].1 += to_world(arm.cross(sign * push));
        }
    }
    shear_springs::add_wrenches(springs, bodies, &mut all);
    all
}
