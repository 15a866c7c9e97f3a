//! The end of a descent where ties and stops are so many, or springs so unlike, that smoothing does not get there.
//!
//! Newton's method on the conditions of balance themselves: near a pose the best motion is that of a [`Problem`] in which nothing is smoothed,
//! with the curvature of what carries at the last one. Its forces balance to the last digits, and are what is told: on a spring so stiff
//! that a last bit of the object's place is more than its load, place and stiffness alone cannot say it.

use super::descent::Descent;
use super::interior::{Problem, Solution, Spring};
use super::model::{add_curvature, add_turning, ways};
use super::pairs::Key;
use super::settle::TaxelLoad;
use super::six::{SixBySix, eigen, norm};
use glam::DVec3;
use std::collections::BTreeMap;

/// Motions at most; five to twenty are usual.
const MAX_MOTIONS: usize = 300;
/// Motions that may get no shorter before they are cut.
const PATIENCE: usize = 6;
/// Imbalance at which it is the end, as that of a descent.
const AT_REST: f64 = 1e-7;
/// Looseness of ties and stops at which it is, in springs' forces as a share of the largest of them; less than a descent's at its end.
const LOOSE: f64 = 1e-5;
/// Places may be off by so many last bits of the object's size and way.
const LAST_BITS: f64 = 64.0;
/// Shares of the weight up to this carry nothing.
const NOTHING: f64 = 1e-9;
/// Above this share of the weight a tie must hold.
const SOMETHING: f64 = 1e-7;

/// What holds an object.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    /// On the object, in the world, newtons.
    pub force: DVec3,
    /// About the centre of mass, N·m.
    pub torque: DVec3,
    /// Taxels whose stops carry.
    pub n_saturated: usize,
}

/// A problem around a pose, and the curvature of the energy there, with its negative eigenvalues.
struct Around {
    problem: Problem,
    curvature: SixBySix,
}

type Forces = BTreeMap<(Key, u32), f64>;

impl Descent<'_> {
    /// Goes on from a pose that is nearly at rest; `None`, and the pose as it was, if that leads nowhere.
    pub(super) fn finish(&mut self) -> Option<Held> {
        let before = (self.center, self.rotation);
        let found = self.newton();
        if found.is_none() {
            (self.center, self.rotation) = before;
            self.look_again();
        }
        found
    }

    fn newton(&mut self) -> Option<Held> {
        self.reach = self.nearby();
        self.look_again();
        let mut forces = self.forces_of_loads();
        let (mut limit, mut shortest, mut n_vain) = (self.nearby(), f64::INFINITY, 0);
        let mut damping = 0.0;
        for _ in 0..MAX_MOTIONS {
            let around = self.around(&forces, damping);
            let Some(solution) = around.problem.solve() else {
                damping = 10.0 * damping.max(1e-3);
                continue;
            };
            forces = self.forces_of(&solution);
            if let Some(held) = self.held(&around, &solution) {
                let Some(way) = around.problem.way_down(&solution, &around.curvature) else {
                    self.remember(&solution);
                    return Some(held);
                };
                // A saddle: down its side.
                let part = 0.5 * limit;
                (shortest, n_vain) = (f64::INFINITY, 0);
                self.go(&way.map(|x| part * x));
                self.look_again();
                continue;
            }
            let unit = self.stroke();
            let length = unit * norm(&solution.motion);
            match length < 0.7 * shortest {
                true => (shortest, n_vain) = (length, 0),
                // What is cut is on its way.
                false => n_vain += usize::from(length <= limit),
            }
            if n_vain > PATIENCE {
                (n_vain, limit, damping) = (0, 0.25 * limit, 4.0 * damping.max(1e-4));
            }
            let scale = unit * (limit / length).min(1.0);
            self.go(&solution.motion.map(|x| scale * x));
            self.look_again();
        }
        None
    }

    /// The problem in units that make weight and stroke 1.
    fn around(&self, forces: &Forces, damping: f64) -> Around {
        let (unit, weight) = (self.stroke(), self.weight.length());
        let now = &self.balancer.now;
        let mut problem = Problem::default();
        let mut curvature = [[0.0; 6]; 6];
        for of_taxel in now.pairs.all.chunk_by(|a, b| a.key == b.key) {
            let key = of_taxel[0].key;
            let skin = &self.skins[key.0 as usize];
            let taxel = skin.patch.taxels().at(key.1 as usize);
            let to_patch = skin.world_from_patch.rotation.conjugate();
            let axes = DVec3::AXES.map(|axis| to_patch * axis);
            let first = problem.slopes.len();
            for pair in of_taxel {
                problem.deflections.push(pair.deflection / unit);
                let Some(reach) = pair.reach else {
                    problem.slopes.push([0.0; 6]);
                    continue;
                };
                let (ways, found) = (ways(&axes, pair.arm, self.arm), reach.derivatives());
                problem.slopes.push(ways.map(|way| found.gradient.dot(way)));
                let force = forces.get(&(key, pair.sphere)).copied().unwrap_or(0.0);
                if force > 0.0 {
                    let turning = force / (self.arm * self.arm);
                    add_curvature(&mut curvature, force, &ways, found.curvature);
                    add_turning(&mut curvature, turning, &axes, pair.arm, found.gradient);
                }
            }
            problem.springs.push(Spring {
                stiffness: taxel.stiffness * unit / weight,
                stroke: taxel.stroke / unit,
                pairs: first..problem.slopes.len(),
            });
        }
        let curvature = curvature.map(|row| row.map(|x| x * unit / weight));
        let (values, vectors) = eigen(&curvature);
        let largest = values.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let lowest = values.iter().copied().fold(0.0, f64::min);
        let shift = -1.1 * lowest + 1e-9 * largest + 1e-12 + damping;
        problem.curvature = (values.map(|value| value + shift), vectors);
        let [x, y, z] = (self.weight / weight).to_array();
        problem.weight = [x, y, z, 0.0, 0.0, 0.0];
        Around { problem, curvature }
    }

    /// What carries, if it is as the problem says.
    fn held(&self, around: &Around, solution: &Solution) -> Option<Held> {
        let (unit, weight) = (self.stroke(), self.weight.length());
        let now = &self.balancer.now;
        let bits = LAST_BITS * f64::EPSILON * (self.arm + self.center.length()) / unit;
        let springs = &around.problem.springs;
        let largest = solution.forces.iter().copied().fold(0.0, f64::max);
        for (i, spring) in springs.iter().enumerate() {
            let loose = bits.max(LOOSE * largest / spring.stiffness);
            for j in spring.pairs.clone() {
                let past = around.problem.deflections[j] - solution.inwards[i];
                let carries = solution.forces[j] > SOMETHING;
                if past > loose || carries && past < -loose {
                    return None;
                }
            }
        }
        let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
        for (pair, carried) in now.pairs.all.iter().zip(&solution.forces) {
            if let Some(reach) = pair.reach {
                let rotation = self.skins[pair.key.0 as usize].world_from_patch.rotation;
                let on_object = -carried * weight * reach.derivatives().gradient;
                force += rotation * on_object;
                torque += rotation * pair.arm.cross(on_object);
            }
        }
        let held = Held {
            force,
            torque,
            n_saturated: solution
                .stops
                .iter()
                .filter(|&&stop| stop > NOTHING)
                .count(),
        };
        (self.imbalance_of(force, torque) <= AT_REST).then_some(held)
    }

    fn forces_of_loads(&self) -> Forces {
        let now = &self.balancer.now;
        let mut forces = Forces::new();
        for load in now.loads.carrying() {
            for at in load.pairs.clone() {
                let pair = &now.pairs.all[at];
                forces.insert((pair.key, pair.sphere), now.loads.shares[at] * load.force);
            }
        }
        forces
    }

    fn forces_of(&self, solution: &Solution) -> Forces {
        let weight = self.weight.length();
        let pairs = self.balancer.now.pairs.all.iter().zip(&solution.forces);
        let carrying = pairs.filter(|(_, force)| **force > NOTHING);
        carrying
            .map(|(pair, force)| ((pair.key, pair.sphere), weight * force))
            .collect()
    }

    /// What carries, and the multipliers for the next rest nearby.
    fn remember(&mut self, solution: &Solution) {
        let weight = self.weight.length();
        let (mut stops, mut shares) = (BTreeMap::new(), BTreeMap::new());
        let mut carried = Vec::new();
        let pairs = self.balancer.now.pairs.all.iter().zip(&solution.forces);
        let pairs: Vec<_> = pairs.collect();
        for (of_taxel, stop) in pairs
            .chunk_by(|a, b| a.0.key == b.0.key)
            .zip(&solution.stops)
        {
            let key = of_taxel[0].0.key;
            let own = of_taxel.iter().filter(|(pair, _)| pair.reach.is_some());
            let force: f64 = own.map(|(_, force)| weight * **force).sum();
            if force > NOTHING * weight {
                carried.push(TaxelLoad::new(key, force, *stop > NOTHING, self.skins));
            }
            if *stop > NOTHING {
                stops.insert(key, weight * stop);
            }
            let carrying: Vec<_> = of_taxel
                .iter()
                .filter(|(_, force)| **force > NOTHING)
                .collect();
            let all: f64 = carrying.iter().map(|(_, force)| **force).sum();
            if carrying.len() > 1 {
                let share = carrying
                    .iter()
                    .map(|(pair, force)| (pair.sphere, **force / all));
                shares.insert(key, share.collect());
            }
        }
        self.multipliers.stops = stops;
        self.multipliers.shares = shares;
        self.balancer.carried = carried;
    }

    fn stroke(&self) -> f64 {
        2.0 * self.farthest
    }
}
