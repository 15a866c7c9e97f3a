//! Sensor errors of single taxels: what each reads follows from its number, the frame and the time, whoever else is read.
//!
//! Draws are [by number](crate::random::CounterKey), four neighbours a counter, and computed for [`LANES`] counters at a time.

use super::Quantisation;
use crate::contact::{Instructions, for_instructions};
use crate::random::{CounterKey, GROUP};

/// Taxels that are read together. More: memory beside the processor; fewer: blocks of counters that are not full.
pub(super) const CHUNK: usize = 512;
/// Counters that are mixed together: f64 lanes of 512 bits.
const LANES: usize = 8;
/// Halvings of the session between which zeros drift along straight lines: 2⁶ pieces, as many numbers a taxel as [`Drift`](super::SensorError::Drift) has.
const N_HALVINGS: u32 = 6;

/// When a body is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The number of the frame, which names its noise.
    pub frame: u64,
    /// The share of the session that has gone, 0 to 1, which drift goes by.
    pub time: f64,
}

/// A step that each taxel takes by itself, in the unit of its patch.
#[derive(Clone, Copy, Debug)]
pub(super) enum TaxelStep {
    /// x ← x exp(s z − s²/2).
    Gain { key: CounterKey, s: f64 },
    /// x ← x + σ z, drawn anew for each frame.
    Noise { key: CounterKey, std: f64 },
    /// x ← x + σ W(t).
    Drift { key: CounterKey, std: f64 },
    /// x ← 0 with the probability `dead`, a level of its own up to `full_scale` with the probability `stuck`.
    Faults {
        key: CounterKey,
        dead: f64,
        stuck: f64,
        full_scale: f64,
    },
    /// x ← the nearest code.
    Quantisation(Quantisation),
}

/// Eight counters' draws, item by item of their groups.
type Block = [[f64; LANES]; GROUP];

/// Some taxels, and the counters that their draws come from.
pub(super) struct Chunk {
    groups: [[u64; LANES]; CHUNK / LANES],
    n_blocks: usize,
    /// Of each taxel: where its draw is.
    places: [u16; CHUNK],
    draws: [Block; CHUNK / LANES],
}

impl Default for Chunk {
    fn default() -> Self {
        Self {
            groups: [[0; LANES]; CHUNK / LANES],
            n_blocks: 0,
            places: [0; CHUNK],
            draws: [[[0.0; LANES]; GROUP]; CHUNK / LANES],
        }
    }
}

impl Chunk {
    /// Takes at most [`CHUNK`] taxels by their numbers. Neighbours that come one after the other share a counter.
    pub fn lay(&mut self, taxels: &[usize]) {
        let mut n_groups = 0;
        let mut last = u64::MAX;
        for (place, &taxel) in self.places.iter_mut().zip(taxels) {
            let group = (taxel / GROUP) as u64;
            if group != last {
                self.groups[n_groups / LANES][n_groups % LANES] = group;
                n_groups += 1;
                last = group;
            }
            let (block, lane) = ((n_groups - 1) / LANES, (n_groups - 1) % LANES);
            *place = ((block * GROUP + taxel % GROUP) * LANES + lane) as u16;
        }
        self.n_blocks = n_groups.div_ceil(LANES);
    }

    /// Changes what its taxels feel to what they read.
    pub fn apply(&mut self, step: &TaxelStep, moment: Moment, values: &mut [f64]) {
        match *step {
            TaxelStep::Gain { key, s } => {
                self.draw_sum(key, [(0, s)]);
                self.each(values, |value, z| value * (z - 0.5 * s * s).exp());
            }
            TaxelStep::Noise { key, std } => {
                self.draw_sum(key, [(moment.frame, std)]);
                self.each(values, |value, noise| value + noise);
            }
            TaxelStep::Drift { key, std } => {
                let terms = walk(moment.time).map(|(node, weight)| (node, std * weight));
                self.draw_sum(key, terms);
                self.each(values, |value, zero| value + zero);
            }
            TaxelStep::Faults {
                key,
                dead,
                stuck,
                full_scale,
            } => {
                let mut levels = [0.0; CHUNK];
                if stuck > 0.0 {
                    self.draw_uniforms(key, 1);
                    self.each(&mut levels[..values.len()], |_, level| full_scale * level);
                }
                self.draw_uniforms(key, 0);
                let mut levels = levels.iter();
                self.each(values, |value, luck| match levels.next() {
                    _ if luck < dead => 0.0,
                    Some(&level) if luck > 1.0 - stuck => level,
                    _ => value,
                });
            }
            TaxelStep::Quantisation(converter) => converter.convert(values),
        }
    }

    /// Normal numbers at some indices, each so many times.
    fn draw_sum<const N: usize>(&mut self, key: CounterKey, terms: [(u64, f64); N]) {
        let draws = &mut self.draws[..self.n_blocks];
        draws.fill([[0.0; LANES]; GROUP]);
        for (index, weight) in terms {
            let groups = &self.groups[..self.n_blocks];
            add_normals(Instructions::Best, key, index, weight, groups, draws);
        }
    }

    fn draw_uniforms(&mut self, key: CounterKey, index: u64) {
        let groups = &self.groups[..self.n_blocks];
        let draws = &mut self.draws[..self.n_blocks];
        lay_uniforms(Instructions::Best, key, index, groups, draws);
    }

    fn each(&self, values: &mut [f64], mut read: impl FnMut(f64, f64) -> f64) {
        let draws = self.draws.as_flattened().as_flattened();
        for (value, &place) in values.iter_mut().zip(&self.places) {
            *value = read(*value, draws[place as usize]);
        }
    }
}

/// A Wiener process at a time from 0 to 1 as a sum of normal numbers, by Lévy's construction: number 0 is where it ends, and each halving
/// of a piece of time displaces its middle by another number, 2ˡ + k for piece k of 2ˡ.
fn walk(time: f64) -> [(u64, f64); 1 + N_HALVINGS as usize] {
    let mut terms = [(0, time); 1 + N_HALVINGS as usize];
    for (halving, term) in terms[1..].iter_mut().enumerate() {
        let n_pieces = 1u64 << halving;
        let within = time * n_pieces as f64;
        let piece = (within as u64).min(n_pieces - 1);
        let tent = 1.0 - (2.0 * (within - piece as f64) - 1.0).abs();
        *term = (n_pieces + piece, 0.5 * tent / (n_pieces as f64).sqrt());
    }
    terms
}

for_instructions! {
    /// Adds `weight` times the normal numbers of an index.
    fn add_normals(
        key: CounterKey,
        index: u64,
        weight: f64,
        groups: &[[u64; LANES]],
        sums: &mut [Block],
    ) = add_each
}

#[inline(always)]
fn add_each(key: CounterKey, index: u64, weight: f64, groups: &[[u64; LANES]], sums: &mut [Block]) {
    for block in 0..groups.len() {
        let normals = key.normals(&groups[block], index);
        for item in 0..GROUP {
            for k in 0..LANES {
                sums[block][item][k] += weight * normals[item][k];
            }
        }
    }
}

for_instructions! {
    /// Writes the uniform numbers of an index.
    fn lay_uniforms(
        key: CounterKey,
        index: u64,
        groups: &[[u64; LANES]],
        uniforms: &mut [Block],
    ) = lay_each
}

#[inline(always)]
fn lay_each(key: CounterKey, index: u64, groups: &[[u64; LANES]], uniforms: &mut [Block]) {
    for block in 0..groups.len() {
        uniforms[block] = key.uniforms(&groups[block], index);
    }
}
