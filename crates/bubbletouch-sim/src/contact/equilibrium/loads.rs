//! Loads of taxels, and their distribution among the spheres that push them.
//!
//! For taxel i with ψ the smoothed maximum of its deflections, k its stiffness and s its stroke, the energy is
//!
//! ```text
//! E = Σ ½ k ψ² + (max(0, λ + κ (ψ − s))² − λ²) / 2κ
//! ```
//!
//! The smoothed maximum ψ is measured from the taxel's free position, and k includes the damper's stiffness within the step. For a rigid contact k = s = 0.
//!
//! The second term is the augmented Lagrangian of the rigid stop ψ ≤ s \[RW\]. With the correct λ the stop holds exactly, and
//! λ is the force on it.

use super::pair::{Key, Pair, Part};
use super::pairs::{Group, Pairs};
use super::tied_max::tied_max;
use std::collections::BTreeMap;

/// Lagrange multipliers of stops and of taxels shared by several spheres.
#[derive(Clone, Debug, Default)]
pub(super) struct Multipliers {
    /// Multipliers λ: the forces on stops, newtons.
    pub stops: BTreeMap<Key, f64>,
    /// Shares w⁰ of each sphere in the force of a taxel that several spheres push.
    pub shares: BTreeMap<Key, Vec<(Part, f64)>>,
}

/// Parameters that smooth the kinks of the energy.
#[derive(Clone, Copy, Debug)]
pub(super) struct Smoothness {
    /// Smoothing width μ of soft taxels, metres.
    pub smoothing: f64,
    /// Smoothing width of stiff taxels, given as the force μ k relative to the weight. A width that is small for a soft taxel can exceed the deflection of a
    /// stiff one.
    pub load: f64,
    /// Minimum smoothing width μ, metres; below this value rounding of deflections would decide ties.
    pub least: f64,
    /// Stiffness κ of stops in the augmented Lagrangian, N/m.
    pub stop_stiffness: f64,
}

impl Smoothness {
    /// Returns the smoothing width μ of a taxel, metres.
    fn for_group(&self, group: &Group) -> f64 {
        let of_load = self.load * group.weight / group.stiffness;
        self.smoothing.min(of_load).max(self.least)
    }

    /// Multiplies the smoothing width by a factor below 1.
    pub fn tighten(&mut self, factor: f64) {
        self.smoothing *= factor;
        self.load *= factor;
    }
}

/// Load of all spheres together on one taxel or rigid contact.
#[derive(Clone, Debug)]
pub(super) struct Load {
    /// Number of spheres that carry a share of the force.
    pub n_sharing: usize,
    /// Largest deflection max δ that contact with a sphere requires, metres; negative if nothing touches the taxel.
    pub deepest: f64,
    /// Smoothing width μ of the taxel, metres.
    pub smoothing: f64,
    /// Force of the taxel's stop, newtons.
    pub stop: f64,
    /// Force along the axis, including the stop's force, newtons; 0 if nothing touches the taxel.
    pub force: f64,
    /// Derivative of the taxel's force with respect to the smoothed maximum ψ, N/m.
    pub tangent: f64,
}

/// Loads of all taxels and rigid contacts.
#[derive(Clone, Debug, Default)]
pub(super) struct Loads {
    /// Loads, one per taxel or rigid contact.
    pub all: Vec<Load>,
    /// Shares of the taxels' forces, one per pair.
    pub shares: Vec<f64>,
    /// Elastic energy E, joules.
    pub elastic: f64,
    /// Deflections that contact with the spheres requires, metres, one per pair.
    deflections: Vec<f64>,
    known: Vec<f64>,
    sharing: Vec<f64>,
}

impl Loads {
    /// Computes the loads of pairs with the given deflections, metres.
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
        let smoothing = smoothness.for_group(group);
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

    /// Returns the groups with a nonzero load, and these loads.
    pub fn carrying<'a>(
        &'a self,
        groups: &'a [Group],
    ) -> impl Iterator<Item = (&'a Group, &'a Load)> {
        let all = groups.iter().zip(&self.all);
        all.filter(|(_, load)| load.force > 0.0)
    }

    /// Returns the multipliers that keep a pose at rest when the smoothing is removed.
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
