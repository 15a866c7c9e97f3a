//! Loads of taxels, and the distribution of each load among the spheres that push the taxel.
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

/// Lagrange multipliers: forces of taxels at the end of their stroke, and shares of spheres that push one taxel together.
#[derive(Clone, Debug, Default)]
pub(super) struct Multipliers {
    /// Forces of the hard limit at the end of the stroke, newtons, for each taxel; forces of rigid contacts.
    pub stops: BTreeMap<Key, f64>,
    /// Shares of the spheres in the force of a taxel that several spheres push.
    pub shares: BTreeMap<Key, Vec<(Part, f64)>>,
}

/// Parameters that smooth the kinks of the energy, where one sphere takes over a taxel from another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Smoothness {
    /// Width of the smoothing between spheres that push one taxel equally far, for soft taxels, metres.
    pub smoothing: f64,
    /// Width of the smoothing between spheres that push one taxel equally far, for stiff taxels, given as a force (width times stiffness) relative to the
    /// weight. A width that is small for a soft taxel can exceed the deflection of a stiff taxel.
    pub load: f64,
    /// Minimum width of the smoothing, metres; below this value, rounding of deflections would decide ties between spheres.
    pub least: f64,
    /// Stiffness of the hard limit at the end of each taxel's stroke, N/m, in the augmented Lagrangian.
    pub stop_stiffness: f64,
}

impl Smoothness {
    /// Returns the width of the smoothing between spheres that push a taxel equally far, metres.
    fn for_group(&self, group: &Group) -> f64 {
        let stiffness = match group.key {
            Key::Taxel(..) => group.stiffness,
            Key::Rigid(..) => 0.1 * self.stop_stiffness,
        };
        let of_load = self.load * group.weight / stiffness;
        self.smoothing.min(of_load).max(self.least)
    }

    /// Multiplies the widths of the smoothing by a factor below 1.
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
    /// Largest deflection that contact with a sphere requires, metres; negative if nothing touches the taxel.
    pub deepest: f64,
    /// Width of the smoothing between spheres that push the taxel equally far, metres.
    pub smoothing: f64,
    /// Force of the hard limit at the end of the taxel's stroke, newtons.
    pub stop: f64,
    /// Force along the taxel's axis, newtons, including the force at the end of the stroke; 0 if nothing touches the taxel.
    pub force: f64,
    /// Derivative of the taxel's force with respect to the smoothed maximum of the required deflections, N/m.
    pub tangent: f64,
}

/// Loads of all taxels and rigid contacts, with the shares of the spheres.
#[derive(Clone, Debug, Default)]
pub(super) struct Loads {
    /// Loads, one per taxel or rigid contact.
    pub all: Vec<Load>,
    /// Share of each pair's sphere in the force of its taxel.
    pub shares: Vec<f64>,
    /// Elastic energy of all taxels, joules.
    pub elastic: f64,
    /// Deflections that contact with the spheres requires, metres, one per pair of sphere and taxel.
    deflections: Vec<f64>,
    known: Vec<f64>,
    sharing: Vec<f64>,
}

impl Loads {
    /// Computes the loads of all pairs of spheres and taxels or rigid contacts from their deflections, metres.
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

    /// Returns the taxels and rigid contacts with a nonzero load, and these loads.
    pub fn carrying<'a>(
        &'a self,
        groups: &'a [Group],
    ) -> impl Iterator<Item = (&'a Group, &'a Load)> {
        let all = groups.iter().zip(&self.all);
        all.filter(|(_, load)| load.force > 0.0)
    }

    /// Returns the Lagrange multipliers for which the pose remains an equilibrium when the smoothing is removed.
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
