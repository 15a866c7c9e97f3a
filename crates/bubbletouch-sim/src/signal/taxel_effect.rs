//! Effects on single taxels: the reading of a taxel depends on its index, the frame and the time, and on no other taxel.
//!
//! The random numbers are counter-based. Four adjacent taxels share a counter, and [`LANES`] counters are computed at
//! a time.

use crate::random::{CounterKey, GROUP};
use multiversion::multiversion;
use std::fmt;
use std::sync::Arc;

/// Number of taxels that are processed together. If larger, the data leave the processor's cache; if smaller, blocks of counters are only partly used.
pub(super) const CHUNK: usize = 512;
/// Number of random-number counters that are computed together: eight f64 values in a vector of 512 bits.
const LANES: usize = 8;

/// Time at which a whole body is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Index of the frame, which selects the noise.
    pub frame: u64,
    /// Elapsed fraction of the recording session, 0 to 1, which determines the drift.
    pub time: f64,
}

/// Step of a `BodyReadout`, prepared for one patch: a function that replaces the true values of the taxels in a chunk by readings, in the unit of the frames of the
/// patch. The step acts on each taxel independently.
#[derive(Clone)]
pub struct TaxelEffect(Arc<Replace>);

/// Function that replaces the values of the taxels in a chunk.
type Replace = dyn Fn(&mut Chunk, Moment, &mut [f64]) + Send + Sync;

impl TaxelEffect {
    pub(super) fn new(
        read: impl Fn(&mut Chunk, Moment, &mut [f64]) + Send + Sync + 'static,
    ) -> Self {
        Self(Arc::new(read))
    }

    pub(super) fn apply(&self, chunk: &mut Chunk, moment: Moment, values: &mut [f64]) {
        (self.0)(chunk, moment, values);
    }
}

impl fmt::Debug for TaxelEffect {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("TaxelEffect")
    }
}

/// Random numbers of eight counters, four numbers per counter. The first index is the number within the counter, the second is the counter.
type Block = [[f64; LANES]; GROUP];

/// Block of up to [`CHUNK`] taxels, with the counters of their random numbers.
pub struct Chunk {
    groups: [[u64; LANES]; CHUNK / LANES],
    n_blocks: usize,
    /// Flattened index in `draws` of each taxel's random number.
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
    /// Stores the indices of the taxels, at most [`CHUNK`]. Consecutive taxels of one group of four share a random-number counter.
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

    /// Draws one random number per taxel: the weighted sum of its normal numbers. `terms` lists the indices of these numbers and their weights.
    pub(super) fn draw_sum<const N: usize>(&mut self, key: CounterKey, terms: [(u64, f64); N]) {
        let draws = &mut self.draws[..self.n_blocks];
        draws.fill([[0.0; LANES]; GROUP]);
        for (index, weight) in terms {
            let groups = &self.groups[..self.n_blocks];
            add_normals(key, index, weight, groups, draws);
        }
    }

    /// Draws one random number per taxel, uniform in [0, 1).
    pub(super) fn draw_uniforms(&mut self, key: CounterKey, index: u64) {
        let groups = &self.groups[..self.n_blocks];
        let draws = &mut self.draws[..self.n_blocks];
        lay_uniforms(key, index, groups, draws);
    }

    /// Replaces each value by `read(value, draw)`, where `draw` is the random number that was last drawn for the taxel.
    pub(super) fn each(&self, values: &mut [f64], mut read: impl FnMut(f64, f64) -> f64) {
        let draws = self.draws.as_flattened().as_flattened();
        for (value, &place) in values.iter_mut().zip(&self.places) {
            *value = read(*value, draws[place as usize]);
        }
    }
}

/// Adds `weight` times the normal numbers at `index` to `sums`, for all groups of taxels.
#[multiversion(targets(
    "x86_64+avx512f+avx512bw+avx512dq+avx512vl+avx2+fma",
    "x86_64+avx2+fma"
))]
fn add_normals(
    key: CounterKey,
    index: u64,
    weight: f64,
    groups: &[[u64; LANES]],
    sums: &mut [Block],
) {
    for block in 0..groups.len() {
        let normals = key.normals(&groups[block], index);
        for item in 0..GROUP {
            for k in 0..LANES {
                sums[block][item][k] += weight * normals[item][k];
            }
        }
    }
}

/// Writes the uniform random numbers at `index` to `uniforms`, for all groups of taxels.
#[multiversion(targets(
    "x86_64+avx512f+avx512bw+avx512dq+avx512vl+avx2+fma",
    "x86_64+avx2+fma"
))]
fn lay_uniforms(key: CounterKey, index: u64, groups: &[[u64; LANES]], uniforms: &mut [Block]) {
    for block in 0..groups.len() {
        uniforms[block] = key.uniforms(&groups[block], index);
    }
}
