//! The end of a descent where ties and stops are so many, or springs so unlike, that smoothing does not get there.
//!
//! Newton's method on the conditions of balance themselves: near a pose the best motion is that of a [`Problem`] in which nothing is smoothed,
//! with the curvature of what carries at the last one. Its forces balance to the last digits, and are what is told: on a spring so stiff
//! that a last bit of the object's place is more than its load, place and stiffness alone cannot say it.

use super::descent::Descent;
use super::energy::PairLoad;
use super::interior::{Problem, Solution, Spring};
use super::loads::Multipliers;
use super::pairs::{Key, Part};
use super::symmetric::{Symmetric, norm};
use std::collections::BTreeMap;

/// Motions at most; five to twenty are usual.
const MAX_MOTIONS: usize = 300;
/// Motions that may get no shorter before they are cut.
const PATIENCE: usize = 6;
/// Imbalance at which it is the end, as that of a descent.
const AT_REST: f64 = 1e-7;
/// Looseness of ties and stops at which it is, in springs' forces as a share of the largest of them; less than a descent's at its end.
const LOOSE: f64 = 1e-5;
/// How far from something rigid what carries may be, metres.
const RIGID: f64 = 3e-10;
/// Places may be off by so many last bits of the object's size and way.
const LAST_BITS: f64 = 64.0;
/// Shares of the weight up to this carry nothing.
const NOTHING: f64 = 1e-9;
/// Above this share of the weight a tie must hold.
const SOMETHING: f64 = 1e-7;

/// A problem around a pose, and the curvature of the energy there, with its negative eigenvalues.
struct Around {
    problem: Problem,
    curvature: Symmetric,
}

type Forces = BTreeMap<(Key, Part), f64>;

impl Descent<'_, '_> {
    /// Goes on from a pose that is nearly at rest, to what carries there; `None`, and the pose as it was, if that leads nowhere.
    pub(super) fn finish(&mut self) -> Option<Vec<PairLoad>> {
        let before = self.bodies.clone();
        let found = self.newton();
        if found.is_none() {
            self.bodies = before;
            self.look_again();
        }
        found
    }

    fn newton(&mut self) -> Option<Vec<PairLoad>> {
        self.reach = self.nearby();
        self.look_again();
        let loads = self.balancer.now.pair_loads();
        let mut forces = self.forces_of(&loads);
        let (mut limit, mut shortest, mut n_vain) = (self.nearby(), f64::INFINITY, 0);
        let mut damping = 0.0;
        for _ in 0..MAX_MOTIONS {
            let around = self.around(&forces, damping);
            let Some(solution) = around.problem.solve() else {
                damping = 10.0 * damping.max(1e-3);
                continue;
            };
            let loads = self.loads_of(&around, &solution);
            forces = self.forces_of(&loads);
            if self.holds(&around, &solution, &loads) {
                let Some(way) = around.problem.way_down(&solution, &around.curvature) else {
                    self.remember(&loads);
                    return Some(loads);
                };
                // A saddle: down its side.
                (shortest, n_vain) = (f64::INFINITY, 0);
                self.go_part(&way, 0.5 * limit);
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
            self.go_part(&solution.motion, unit * (limit / length).min(1.0));
        }
        None
    }

    fn go_part(&mut self, motion: &[f64], part: f64) {
        let motion: Vec<f64> = motion.iter().map(|x| part * x).collect();
        self.go(&motion);
        self.look_again();
    }

    /// The problem in units that make all weights together and the stroke 1.
    fn around(&self, forces: &Forces, damping: f64) -> Around {
        let (unit, weight) = (self.stroke(), self.total_weight());
        let pairs = &self.balancer.now.pairs;
        let mut problem = Problem::default();
        let mut curvature = Symmetric::default();
        let force_of = |at: usize| {
            let pair = &pairs.all[at];
            forces.get(&(pair.key, pair.part)).copied().unwrap_or(0.0)
        };
        let skins = &self.ground.skins;
        let slopes = &mut problem.slopes;
        slopes.lay(&self.bodies, skins, pairs, &mut curvature, force_of);
        let deflections = pairs.all.iter().map(|pair| pair.deflection / unit);
        problem.deflections = deflections.collect();
        let springs = pairs.groups.iter().map(|group| Spring {
            stiffness: group.stiffness * unit / weight,
            stroke: group.stroke / unit,
            pairs: group.pairs.clone(),
        });
        problem.springs = springs.collect();
        curvature.scale(unit / weight);
        let least = 1e-9 * curvature.size() + 1e-12;
        let lowest = curvature.lowest_below(least).map_or(0.0, |lowest| lowest.0);
        problem.curvature = curvature.clone();
        problem
            .curvature
            .shift(2.0 * least - 1.1 * lowest + damping);
        let weights = self.bodies.iter().flat_map(|body| {
            let [x, y, z] = (body.weight / weight).to_array();
            [x, y, z, 0.0, 0.0, 0.0]
        });
        problem.weight = weights.collect();
        Around { problem, curvature }
    }

    /// Whether what carries is as the problem says.
    fn holds(&self, around: &Around, solution: &Solution, loads: &[PairLoad]) -> bool {
        let unit = self.stroke();
        let farthest =
            |size: f64, body: &super::body::Body| size.max(body.arm() + body.center.length());
        let size = self.bodies.iter().fold(0.0, farthest);
        let bits = LAST_BITS * f64::EPSILON * size / unit;
        let springs = &around.problem.springs;
        let largest = solution.forces.iter().copied().fold(0.0, f64::max);
        for (i, spring) in springs.iter().enumerate() {
            let loose = match spring.stiffness {
                0.0 => RIGID / unit,
                stiffness => LOOSE * largest / stiffness,
            };
            let loose = bits.max(loose);
            for j in spring.pairs.clone() {
                let past = around.problem.deflections[j] - solution.inwards[i];
                let carries = solution.forces[j] > SOMETHING;
                if past > loose || carries && past < -loose {
                    return false;
                }
            }
        }
        self.imbalance(loads) <= AT_REST
    }

    fn forces_of(&self, loads: &[PairLoad]) -> Forces {
        let pairs = &self.balancer.now.pairs.all;
        let all = loads.iter().map(|load| {
            let pair = &pairs[load.pair];
            ((pair.key, pair.part), load.force)
        });
        all.collect()
    }

    /// What each pair carries in a solution.
    fn loads_of(&self, around: &Around, solution: &Solution) -> Vec<PairLoad> {
        let weight = self.total_weight();
        let mut loads = Vec::new();
        for (spring, stop) in around.problem.springs.iter().zip(&solution.stops) {
            let carrying = |j: &usize| solution.forces[*j] > NOTHING;
            let all: f64 = solution.forces[spring.pairs.clone()].iter().sum();
            // The reaction is what the spring at its stroke does not carry.
            let past = (all - spring.stiffness * spring.stroke).max(0.0) / all;
            let stopped = if *stop > NOTHING { past } else { 0.0 };
            loads.extend(spring.pairs.clone().filter(carrying).map(|pair| PairLoad {
                pair,
                force: weight * solution.forces[pair],
                stop: stopped * weight * solution.forces[pair],
            }));
        }
        loads
    }

    /// The multipliers for the next rest nearby.
    fn remember(&mut self, loads: &[PairLoad]) {
        let pairs = &self.balancer.now.pairs.all;
        let mut multipliers = Multipliers::default();
        for of_key in loads.chunk_by(|a, b| pairs[a.pair].key == pairs[b.pair].key) {
            let key = pairs[of_key[0].pair].key;
            let stop: f64 = of_key.iter().map(|load| load.stop).sum();
            if stop > 0.0 {
                multipliers.stops.insert(key, stop);
            }
            let all: f64 = of_key.iter().map(|load| load.force).sum();
            if of_key.len() > 1 {
                let shares = of_key
                    .iter()
                    .map(|load| (pairs[load.pair].part, load.force / all));
                multipliers.shares.insert(key, shares.collect());
            }
        }
        self.multipliers = multipliers;
    }

    fn stroke(&self) -> f64 {
        2.0 * self.farthest
    }
}
