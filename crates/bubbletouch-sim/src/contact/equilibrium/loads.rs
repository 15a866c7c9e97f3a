//! What taxels carry, and how the spheres that push them share it.
//!
//! For taxel i with ψ the smoothed maximum of its deflections, k its stiffness and s its stroke, the energy is
//!
//! ```text
//! E = Σ ½ k ψ² + (max(0, λ + κ (ψ − s))² − λ²) / 2κ
//! ```
//!
//! (ψ from where the taxel is if nothing pushes it, with k as stiff as its damper makes it within the step; k = s = 0 of what is rigid)
//!
//! the second part being the augmented Lagrangian of the rigid stop ψ ≤ s \[RW\]: with the right λ the stop holds exactly, and
//! λ is what it carries.

use super::pair::{Key, Pair, Part};
use super::pairs::{Group, Pairs};
use super::tied_max::tied_max;
use std::collections::BTreeMap;

/// What is known of the forces inside taxels.
#[derive(Clone, Debug, Default)]
pub(super) struct Multipliers {
    /// λ: what stops carry, newtons.
    pub stops: BTreeMap<Key, f64>,
    /// w⁰ of taxels that several spheres share.
    pub shares: BTreeMap<Key, Vec<(Part, f64)>>,
}

/// How the energy is made smooth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Smoothness {
    /// μ of soft taxels, metres.
    pub smoothing: f64,
    /// μ k of stiff ones, as a share of the weight: a smoothing that is little on a soft taxel is more than what its stiff neighbour goes.
    pub load: f64,
    /// The least μ, metres: less than rounding of deflections would decide ties.
    pub least: f64,
    /// κ, N/m.
    pub stop_stiffness: f64,
}

impl Smoothness {
    /// μ of a taxel, metres.
    fn of(&self, group: &Group) -> f64 {
        let of_load = self.load * group.weight / group.stiffness;
        self.smoothing.min(of_load).max(self.least)
    }

    /// Ties are steeper by this factor below 1.
    pub fn tighten(&mut self, factor: f64) {
        self.smoothing *= factor;
        self.load *= factor;
    }
}

/// What a group of pairs puts on a taxel.
#[derive(Clone, Debug)]
pub(super) struct Load {
    /// Pairs with a share above zero.
    pub n_sharing: usize,
    /// max δ, metres; negative if nothing touches it.
    pub deepest: f64,
    /// μ, metres.
    pub smoothing: f64,
    /// What the stop carries, newtons.
    pub stop: f64,
    /// Along the axis, with the stop's, newtons; 0 if nothing touches it.
    pub force: f64,
    /// Its derivative by ψ, N/m.
    pub tangent: f64,
}

/// The loads of all groups of pairs.
#[derive(Clone, Debug, Default)]
pub(super) struct Loads {
    /// One a group.
    pub all: Vec<Load>,
    /// One a pair.
    pub shares: Vec<f64>,
    /// E, joules.
    pub elastic: f64,
    /// One a pair.
    deflections: Vec<f64>,
    known: Vec<f64>,
    sharing: Vec<f64>,
}

impl Loads {
    /// Computes the loads of pairs with these deflections, metres.
    pub fn weigh(
        &mut self,
        (multipliers, smoothness): (&Multipliers, &Smoothness),
        pairs: &Pairs,
        deflection: impl Fn((usize, &Pair)) -> f64,
    ) {
        self.all.clear();
        self.shares.clear();
        self.elastic = 0.0;
        let mut deflections = std::mem::take(&mut self.deflections);
        deflections.clear();
        deflections.extend(pairs.all.iter().enumerate().map(deflection));
        for group in &pairs.groups {
            let places = group.pairs.clone();
            let pairs = (&pairs.all[places.clone()], &deflections[places]);
            self.weigh_group((multipliers, smoothness), group, pairs);
        }
        self.deflections = deflections;
    }

    fn weigh_group(
        &mut self,
        (multipliers, smoothness): (&Multipliers, &Smoothness),
        group: &Group,
        (pairs, deflections): (&[Pair], &[f64]),
    ) {
        let known = multipliers.shares.get(&group.key);
        if let Some(known) = known {
            let of = |p: &Pair| known.iter().find(|k| k.0 == p.part).map_or(0.0, |k| k.1);
            self.known.clear();
            self.known.extend(pairs.iter().map(of));
        }
        let known = known.map(|known| (&self.known[..], known.iter().map(|k| k.1 * k.1).sum()));
        let smoothing = smoothness.of(group);
        let max = tied_max(deflections, known, smoothing, &mut self.sharing);
        self.shares.extend_from_slice(&self.sharing);
        let lambda = multipliers.stops.get(&group.key).copied().unwrap_or(0.0);
        let (k, kappa) = (group.stiffness, smoothness.stop_stiffness);
        let stop = (lambda + kappa * (max.value - group.stroke)).max(0.0);
        let value = max.value.max(0.0);
        self.elastic += 0.5 * k * (value.powi(2) - group.others.powi(2))
            + 0.5 * (stop * stop - lambda * lambda) / kappa;
        self.all.push(Load {
            n_sharing: max.n_sharing,
            deepest: deflections
                .iter()
                .copied()
                .fold(f64::NEG_INFINITY, f64::max),
            smoothing,
            stop,
            force: k * value + stop,
            tangent: if value > 0.0 { k } else { 0.0 } + if stop > 0.0 { kappa } else { 0.0 },
        });
    }

    /// Those that are not zero, with what they are of.
    pub fn carrying<'a>(
        &'a self,
        groups: &'a [Group],
    ) -> impl Iterator<Item = (&'a Group, &'a Load)> {
        let all = groups.iter().zip(&self.all);
        all.filter(|(_, load)| load.force > 0.0)
    }

    /// The multipliers that make a pose at rest one at rest without smoothing.
    pub fn multipliers(&self, pairs: &Pairs) -> Multipliers {
        let mut multipliers = Multipliers::default();
        for (group, load) in self.carrying(&pairs.groups) {
            if load.stop > 0.0 {
                multipliers.stops.insert(group.key, load.stop);
            }
            if load.n_sharing > 1 {
                let shares = group.pairs.clone().filter(|&at| self.shares[at] > 0.0);
                let shares = shares.map(|at| (pairs.all[at].part, self.shares[at]));
                multipliers.shares.insert(group.key, shares.collect());
            }
        }
        multipliers
    }
}
