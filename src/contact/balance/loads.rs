//! What taxels carry, and how the spheres that push them share it.
//!
//! For taxel i with ψ the smoothed maximum of its deflections, k its stiffness and s its stroke, the energy is
//!
//! ```text
//! E = Σ ½ k ψ² + (max(0, λ + κ (ψ − s))² − λ²) / 2κ
//! ```
//!
//! the second part being the augmented Lagrangian of the rigid stop ψ ≤ s \[RW\]: with the right λ the stop holds exactly, and
//! λ is what it carries.

use super::free_object::PlacedSkin;
use super::pairs::{Key, Pair};
use super::tied_max::tied_max;
use std::collections::BTreeMap;
use std::ops::Range;

/// What is known of the forces inside taxels.
#[derive(Clone, Debug, Default)]
pub(super) struct Multipliers {
    /// λ: what stops carry, newtons.
    pub stops: BTreeMap<Key, f64>,
    /// w⁰ of taxels that several spheres share.
    pub shares: BTreeMap<Key, Vec<(u32, f64)>>,
}

/// How the energy is made smooth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Smoothness {
    /// μ of soft taxels, metres.
    pub smoothing: f64,
    /// μ k of stiff ones, newtons: a smoothing that is little on a soft taxel is more than what its stiff neighbour goes.
    pub load: f64,
    /// The least μ, metres: less than rounding of deflections would decide ties.
    pub least: f64,
    /// κ, N/m.
    pub stop_stiffness: f64,
}

impl Smoothness {
    /// μ of a taxel of this stiffness (N/m), metres.
    fn of(&self, stiffness: f64) -> f64 {
        self.smoothing.min(self.load / stiffness).max(self.least)
    }

    /// Ties are steeper by this factor below 1.
    pub fn tighten(&mut self, factor: f64) {
        self.smoothing *= factor;
        self.load *= factor;
    }
}

/// A taxel and the pairs that it is in.
#[derive(Clone, Debug)]
pub(super) struct Load {
    pub key: Key,
    pub pairs: Range<usize>,
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

/// The loads of all taxels that pairs are about.
#[derive(Clone, Debug, Default)]
pub(super) struct Loads {
    pub all: Vec<Load>,
    /// One a pair.
    pub shares: Vec<f64>,
    /// E, joules.
    pub elastic: f64,
    known: Vec<f64>,
    sharing: Vec<f64>,
}

impl Loads {
    /// Of pairs (sorted by taxel) whose deflections are these.
    pub fn weigh(
        &mut self,
        pairs: &[Pair],
        deflections: &[f64],
        skins: &[PlacedSkin],
        multipliers: &Multipliers,
        smoothness: Smoothness,
    ) {
        self.all.clear();
        self.shares.clear();
        self.elastic = 0.0;
        let mut first = 0;
        for of_taxel in pairs.chunk_by(|a, b| a.key == b.key) {
            let places = first..first + of_taxel.len();
            first = places.end;
            self.weigh_one(
                of_taxel,
                (places.clone(), &deflections[places]),
                skins,
                multipliers,
                smoothness,
            );
        }
    }

    fn weigh_one(
        &mut self,
        pairs: &[Pair],
        (places, deflections): (Range<usize>, &[f64]),
        skins: &[PlacedSkin],
        multipliers: &Multipliers,
        smoothness: Smoothness,
    ) {
        let key = pairs[0].key;
        self.known.clear();
        let known = multipliers.shares.get(&key);
        if let Some(known) = known {
            let of = |p: &Pair| {
                known
                    .iter()
                    .find(|(s, _)| *s == p.sphere)
                    .map_or(0.0, |k| k.1)
            };
            self.known.extend(pairs.iter().map(of));
        }
        let known = known.map(|known| (&self.known[..], known.iter().map(|k| k.1 * k.1).sum()));
        let (skin, number) = (&skins[key.0 as usize], key.1 as usize);
        let taxel = skin.patch.taxels().at(number);
        let smoothing = smoothness.of(taxel.stiffness);
        let max = tied_max(deflections, known, smoothing, &mut self.sharing);
        self.shares.extend_from_slice(&self.sharing);
        let others = skin.pushed.get(number).copied().unwrap_or(0.0);
        let lambda = multipliers.stops.get(&key).copied().unwrap_or(0.0);
        let (k, kappa) = (taxel.stiffness, smoothness.stop_stiffness);
        let stop = (lambda + kappa * (max.value - taxel.stroke)).max(0.0);
        let value = max.value.max(0.0);
        self.elastic += 0.5 * k * (value.powi(2) - others.powi(2))
            + 0.5 * (stop * stop - lambda * lambda) / kappa;
        self.all.push(Load {
            key,
            pairs: places,
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

    /// The loads that are not zero.
    pub fn carrying(&self) -> impl Iterator<Item = &Load> {
        self.all.iter().filter(|load| load.force > 0.0)
    }

    /// The multipliers that make a pose at rest one at rest without smoothing.
    pub fn multipliers(&self, pairs: &[Pair]) -> Multipliers {
        let mut multipliers = Multipliers::default();
        for load in self.carrying() {
            if load.stop > 0.0 {
                multipliers.stops.insert(load.key, load.stop);
            }
            if load.n_sharing > 1 {
                let shares = load.pairs.clone().filter(|&at| self.shares[at] > 0.0);
                let shares = shares.map(|at| (pairs[at].sphere, self.shares[at]));
                multipliers.shares.insert(load.key, shares.collect());
            }
        }
        multipliers
    }
}
