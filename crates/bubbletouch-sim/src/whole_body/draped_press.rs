//! Presses of spheres on a patch of any surface, by descending the tree of balls to the tiles near a sphere.

use super::draped_patch::{BLOCK, DrapedPatch, Tile};
use super::lanes::{Balls, LANES};
use super::object_press::Pushed;
use super::patch_state::PatchState;
use crate::contact::lanes::SelectedLanes;
use crate::contact::law::{beats, indent, squares_in_front};
use crate::contact::object_at::PlacedSphere;
use glam::DVec3;

/// Maximum number of levels of the tree of bounding balls; each level allows eight times as many taxels.
const MAX_LEVELS: usize = 10;

impl Pushed for DrapedPatch {
    #[inline(always)]
    fn is_near(&self, ball: &PlacedSphere) -> bool {
        Descent::new(&self.levels, ball).next().is_some()
    }

    #[inline(always)]
    fn push(&self, state: &mut PatchState, sphere: &PlacedSphere) {
        for tile in Descent::new(&self.levels, sphere) {
            self.push_tile(state, tile, sphere.center, sphere.reach);
        }
    }
}

impl DrapedPatch {
    /// Raises the deflections of the taxels in a tile by a sphere. `center` is in the patch frame, and `reach` is the sum of the radii of sphere and taxel,
    /// metres.
    #[inline(always)]
    fn push_tile(&self, state: &mut PatchState, tile: usize, center: DVec3, reach: f64) {
        // Squares S² − b² and heights h of each taxel.
        let (mut squares, mut heights) = ([0.0; LANES], [0.0; LANES]);
        let Tile {
            centers: [x, y, z],
            axes: [nx, ny, nz],
        } = &self.tiles[tile];
        for k in 0..LANES {
            let (dx, dy, dz) = (center.x - x[k], center.y - y[k], center.z - z[k]);
            let height = dx * nx[k] + dy * ny[k] + dz * nz[k];
            let (bx, by, bz) = (
                dx - height * nx[k],
                dy - height * ny[k],
                dz - height * nz[k],
            );
            let square = reach * reach - (bx * bx + by * by + bz * bz);
            squares[k] = square;
            heights[k] = height;
        }
        let squares = squares_in_front(&squares, &heights, self.behind);
        let first = tile * LANES;
        let taxels = state.block(first);
        if beats(&squares, &heights, taxels) {
            indent(&squares, &heights, taxels);
            let start = first % BLOCK;
            let end = (start + LANES).min(self.n_taxels - (first - start));
            state.widen(first / BLOCK, &(start as u32..end as u32));
        }
    }
}

/// Iterator over the tiles of taxels near a sphere, ascending.
struct Descent<'a> {
    levels: &'a [Vec<Balls>],
    sphere: &'a PlacedSphere,
    /// Level of the tree of bounding balls that the iterator has reached.
    level: usize,
    /// For each level down to the present one, the index of the visited block and its balls that are still to be visited.
    blocks: [(usize, SelectedLanes); MAX_LEVELS],
}

impl<'a> Descent<'a> {
    #[inline(always)]
    fn new(levels: &'a [Vec<Balls>], sphere: &'a PlacedSphere) -> Self {
        let mut blocks = [(0, SelectedLanes::default()); MAX_LEVELS];
        blocks[0].1 = levels[0][0].near(sphere);
        Self {
            levels,
            sphere,
            level: 0,
            blocks,
        }
    }
}

impl Iterator for Descent<'_> {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        loop {
            let (block, left) = &mut self.blocks[self.level];
            let Some(k) = left.next() else {
                self.level = self.level.checked_sub(1)?;
                continue;
            };
            let ball = *block * LANES + k;
            let Some(below) = self.levels.get(self.level + 1) else {
                return Some(ball);
            };
            self.level += 1;
            self.blocks[self.level] = (ball, below[ball].near(self.sphere));
        }
    }
}
