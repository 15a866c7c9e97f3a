//! Elastic energy of the skins that free objects press at their present poses, and its forces.

use super::body::Body;
use super::free_object::PlacedSkin;
use super::loads::{Load, Loads};
use super::pair::{Key, Pair, Part};
use super::pairs::{Group, Margins, Pairs};
use super::scene::Scene;
use super::shear_springs::{self, Spring};
use glam::DVec3;

/// Weight of violated rigid contacts in [`Energy::complementarity_residual`], 1/m.
const RIGID_MISS: f64 = 1e-7 / 3e-10;

/// Energy at the present poses of all bodies, with the contacts and loads from which its model is built. Reuse avoids allocations.
#[derive(Clone, Debug, Default)]
pub(super) struct Energy {
    pub pairs: Pairs,
    pub loads: Loads,
}

/// Load of one pair on its taxel or rigid contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairLoad {
    /// Number of the pair.
    pub pair: usize,
    /// Force along the axis including the stop's, newtons.
    pub force: f64,
    /// Part of the force carried by the stop, newtons.
    pub stop: f64,
}

impl Energy {
    /// Evaluates the energy at the present poses and gathers the contacts within a motion of `step` metres. `behind` lists the spheres that were
    /// behind taxels at the pose before.
    pub fn look(&mut self, scene: &Scene, step: f64, behind: &[(Key, Part)]) {
        let margins = Margins {
            step,
            window: 2.0 * scene.smoothness.smoothing + 4.0 * step,
        };
        self.pairs
            .look(&scene.bodies, scene.ground, margins, behind);
        self.loads.weigh(
            (&scene.multipliers, &scene.smoothness),
            &self.pairs,
            |(_, pair)| pair.deflection,
        );
        self.loads.elastic += shear_springs::energy(&scene.springs, &scene.bodies);
    }

    /// Returns the load of each pair. Each taxel carries k times its deflection, plus the force of its stop.
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

    /// Returns the complementarity residual of each [island](Pairs::islands), dimensionless, by the island's number; 0 if nothing touches.
    ///
    /// Without violations, spheres that share a taxel push it equally far, a stop that carries is reached exactly, and no stop is passed. The residual
    /// is the taxel's stiffness times the largest violation, divided by the largest force of a spring. Rigid contacts count with
    /// the stiffness [`RIGID_MISS`].
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

    /// Returns the violation of the constraints of one taxel or rigid contact, metres; see [complementarity_residual](Self::complementarity_residual).
    fn miss(&self, group: &Group, load: &Load) -> f64 {
        let past = load.deepest - group.stroke;
        let of_stop: f64 = if load.stop > 0.0 { past.abs() } else { past };
        if load.force == 0.0 {
            // Pressed, but below the smoothed maximum that uses the shares of an earlier pose.
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

/// Returns the force (N) and the torque about the centre of mass (N·m) of pairs and tangential springs on each body, in the world.
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
