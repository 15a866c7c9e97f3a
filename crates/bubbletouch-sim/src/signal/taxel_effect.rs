//! Effects on single taxels: the value that a taxel reads depends on its number, the frame and the time, and on no other taxel.
//!
//! Draws are [by number](crate::random::CounterKey), four neighbours a counter, and computed for [`LANES`] counters at a time.

use crate::contact::{Instructions, for_instructions};
use crate::random::{CounterKey, GROUP};
use std::fmt::Debug;

/// Taxels that are read together. More: memory beside the processor; fewer: blocks of counters that are not full.
pub(super) const CHUNK: usize = 512;
/// Counters that are mixed together: f64 lanes of 512 bits.
const LANES: usize = 8;

/// When a body is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The number of the frame, which names its noise.
    pub frame: u64,
    /// The share of the session that has gone, 0 to 1, which drift goes by.
    pub time: f64,
}

/// Step of a [`BodyReadout`](super::BodyReadout), prepared for one patch: changes each taxel without regard to the others.
pub trait TaxelEffect: Debug + Send + Sync {
    /// Replaces the true values of the taxels in `chunk` by the values that they read, in the unit of their patch.
    fn apply(&self, chunk: &mut Chunk, moment: Moment, values: &mut [f64]);
}

/// Eight counters' draws, item by item of their groups.
type Block = [[f64; LANES]; GROUP];

/// Up to [`CHUNK`] taxels and the counters that their draws come from.
pub struct Chunk {
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
    pub(super) fn lay(&mut self, taxels: &[usize]) {
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

    /// Draws one number per taxel: the weighted sum of the normal numbers at the indices of `terms`.
    pub(super) fn draw_sum<const N: usize>(&mut self, key: CounterKey, terms: [(u64, f64); N]) {
        let draws = &mut self.draws[..self.n_blocks];
        draws.fill([[0.0; LANES]; GROUP]);
        for (index, weight) in terms {
            let groups = &self.groups[..self.n_blocks];
            add_normals(Instructions::Best, key, index, weight, groups, draws);
        }
    }

    /// Draws one number per taxel, uniform in [0, 1).
    pub(super) fn draw_uniforms(&mut self, key: CounterKey, index: u64) {
        let groups = &self.groups[..self.n_blocks];
        let draws = &mut self.draws[..self.n_blocks];
        lay_uniforms(Instructions::Best, key, index, groups, draws);
    }

    /// Replaces each value by `read(value, draw)`, with the taxel's number of the last draw.
    pub(super) fn each(&self, values: &mut [f64], mut read: impl FnMut(f64, f64) -> f64) {
        let draws = self.draws.as_flattened().as_flattened();
        for (value, &place) in values.iter_mut().zip(&self.places) {
            *value = read(*value, draws[place as usize]);
        }
    }
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
