//! Elastic energy of the skins that a free object presses at one pose, and the forces there.

use super::free_object::{FreeObject, PlacedSkin};
use super::loads::Loads;
use super::model::Scene;
use super::pairs::{Key, Margins, Pairs};
use super::settle::TaxelLoad;
use crate::geometry::Pose;
use glam::DVec3;

/// The energy at one pose, and all that its model is made of. Reused: nothing is allocated once it has seen the most pairs.
#[derive(Clone, Debug, Default)]
pub(super) struct Energy {
    pub pairs: Pairs,
    pub loads: Loads,
    deflections: Vec<f64>,
}

impl Energy {
    /// Looks at the object at a pose (`world_from_object`), and at what it would press after a motion of `step` metres;
    /// `behind`: the spheres that were behind taxels before.
    pub fn look(
        &mut self,
        object: &FreeObject,
        scene: &Scene,
        pose: &Pose,
        step: f64,
        behind: &[(Key, u32)],
    ) {
        let margins = Margins {
            step,
            window: 2.0 * scene.smoothness.smoothing + 4.0 * step,
        };
        self.pairs.look(object, scene.skins, pose, margins, behind);
        self.deflections.clear();
        self.deflections
            .extend(self.pairs.all.iter().map(|pair| pair.deflection));
        self.loads.weigh(
            &self.pairs.all,
            &self.deflections,
            scene.skins,
            scene.multipliers,
            scene.smoothness,
        );
    }

    /// Force (N) and torque about the centre of mass (N·m) that the taxels put on the object, in the world, if each carries k
    /// times its deflection and what its stop carries.
    pub fn wrench(&self, skins: &[PlacedSkin]) -> (DVec3, DVec3) {
        let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
        for load in self.loads.carrying() {
            let skin = &skins[load.key.0 as usize];
            let taxel = skin.patch.taxels().at(load.key.1 as usize);
            let carried = taxel.stiffness * load.deepest.min(taxel.stroke) + load.stop;
            for at in load.pairs.clone() {
                let (pair, share) = (&self.pairs.all[at], self.loads.shares[at]);
                if let Some(reach) = pair.reach.filter(|_| share > 0.0) {
                    let on_object = -share * carried * reach.derivatives().gradient;
                    force += skin.world_from_patch.rotation * on_object;
                    torque += skin.world_from_patch.rotation * pair.arm.cross(on_object);
                }
            }
        }
        (force, torque)
    }

    /// What each taxel carries of the object: of the forces of [`wrench`](Self::wrench), without what other objects have of them.
    pub fn carried(&self, skins: &[PlacedSkin]) -> Vec<TaxelLoad> {
        let carried = self.loads.carrying().map(|load| {
            let is_own = |at: &usize| self.pairs.all[*at].reach.is_some();
            let own = load.pairs.clone().filter(is_own);
            let share: f64 = own.map(|at| self.loads.shares[at]).sum();
            let taxel = skins[load.key.0 as usize].patch.taxels();
            let taxel = taxel.at(load.key.1 as usize);
            let force = taxel.stiffness * load.deepest.min(taxel.stroke) + load.stop;
            TaxelLoad::new(load.key, share * force, load.stop > 0.0, skins)
        });
        carried.filter(|load| load.force > 0.0).collect()
    }

    /// How far shares and stops are from what they say: spheres that share a taxel should push it equally far, and a stop that
    /// carries should be met exactly, and none passed. As what the taxel's spring makes of that distance, as a share of the
    /// largest force of a spring; 0 where there is none.
    pub fn looseness(&self, skins: &[PlacedSkin]) -> f64 {
        let (mut worst, mut largest): (f64, f64) = (0.0, 0.0);
        for load in self.loads.carrying() {
            let taxels = skins[load.key.0 as usize].patch.taxels();
            let taxel = taxels.at(load.key.1 as usize);
            let past = load.deepest - taxel.stroke;
            let mut loose: f64 = if load.stop > 0.0 { past.abs() } else { past };
            for at in load.pairs.clone() {
                if self.loads.shares[at] > 1e-9 {
                    loose = loose.max(load.deepest - self.pairs.all[at].deflection);
                }
            }
            worst = worst.max(taxel.stiffness * loose);
            largest = largest.max(taxel.stiffness * load.deepest);
        }
        if largest > 0.0 { worst / largest } else { 0.0 }
    }

    /// How many taxels are pushed along a flank that is as good as parallel to their axis.
    pub fn n_grazing(&self) -> usize {
        let is_grazing = |&at: &usize| {
            let reach = self.pairs.all[at]
                .reach
                .filter(|_| self.loads.shares[at] > 0.0);
            reach.is_some_and(|reach| reach.derivatives().is_grazing)
        };
        let carrying = self.loads.carrying();
        carrying
            .flat_map(|load| load.pairs.clone())
            .filter(is_grazing)
            .count()
    }
}
