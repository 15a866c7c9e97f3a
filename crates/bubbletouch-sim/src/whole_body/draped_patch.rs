//! A patch on any surface: tiles of taxels that each have their own axis.
//!
//! The taxels are kept eight by eight in the order of their layout. Balls are around these tiles, around eight tiles that follow each
//! other, around eight of those, and so on: a sphere goes down to the tiles that it is near.

use super::lanes::{Balls, FAR, LANES, ball_around, filled};
use super::object_press::Pushed;
use super::patch_state::PatchState;
use crate::contact::Below;
use crate::contact::law::{beats, raise, squares_in_front};
use crate::objects::Sphere;
use crate::world::Layout;
use glam::DVec3;

/// Taxels whose touched span is remembered together.
pub(super) const BLOCK: usize = LANES * LANES;
/// Levels of balls, at most: eight times as many taxels with each.
const MOST_LEVELS: usize = 10;

/// Equal taxels that rest anywhere: 61 bytes each with what is remembered of them.
#[derive(Clone, Debug)]
pub(super) struct DrapedPatch {
    n_taxels: usize,
    /// Height of the substrate, metres.
    behind: f64,
    tiles: Vec<Tile>,
    /// The first level is one block of at most eight balls; a ball of a level is around the block of its number of the next one, and of
    /// the last level around a tile.
    levels: Vec<Vec<Balls>>,
    /// Around all taxels from their rest centres back to the substrate, in the patch frame.
    pub ball: Sphere,
}

/// Eight taxels, coordinate by coordinate. The last one is filled up with some far away.
#[derive(Clone, Debug)]
struct Tile {
    /// Rest centres: x, y, z, metres.
    centers: [[f64; LANES]; 3],
    /// Axes: x, y, z.
    axes: [[f64; LANES]; 3],
}

impl DrapedPatch {
    /// Taxels, at least one, with their substrate at the height `behind`, metres.
    pub fn new(layout: &Layout, behind: f64) -> Self {
        let taxels = layout.centers().iter().copied();
        let taxels: Vec<_> = taxels.zip(layout.axes().iter().copied()).collect();
        // From the rest centres back to the substrate.
        let ends = |&(center, axis): &(DVec3, DVec3)| [center, center + behind * axis];
        let ball = |taxels: &[_]| ball_around(taxels.iter().flat_map(ends));
        let balls = |n: usize| taxels.chunks(n).map(ball).collect::<Vec<_>>();
        let mut levels = vec![Balls::blocks(&balls(LANES))];
        let mut size = LANES;
        while levels[0].len() > 1 {
            size *= LANES;
            levels.insert(0, Balls::blocks(&balls(size)));
        }
        Self {
            n_taxels: taxels.len(),
            behind,
            tiles: taxels.chunks(LANES).map(Tile::new).collect(),
            levels,
            ball: ball(&taxels),
        }
    }

    /// Every taxel by itself, in the same order.
    pub fn layout(&self) -> Layout {
        let lane = |lanes: &[[f64; LANES]; 3], k| DVec3::new(lanes[0][k], lanes[1][k], lanes[2][k]);
        let all = |of: fn(&Tile) -> &[[f64; LANES]; 3]| {
            (0..self.n_taxels)
                .map(|taxel| lane(of(&self.tiles[taxel / LANES]), taxel % LANES))
                .collect()
        };
        Layout::new(all(|tile| &tile.centers), all(|tile| &tile.axes))
            .expect("it has been a layout before")
    }

    /// Bytes that it holds on the heap.
    pub fn n_bytes(&self) -> usize {
        let levels = self.levels.iter().map(|balls| size_of_val(&balls[..]));
        size_of_val(&self.tiles[..]) + levels.sum::<usize>()
    }

    /// Pushes a tile.
    #[inline(always)]
    fn push_tile(&self, state: &mut PatchState, tile: usize, center: DVec3, reach: f64) {
        // Of each taxel S² − b² and h.
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
            raise(&squares, &heights, taxels);
            let start = first % BLOCK;
            let end = (start + LANES).min(self.n_taxels - (first - start));
            state.widen(first / BLOCK, &(start as u32..end as u32));
        }
    }
}

impl Pushed for DrapedPatch {
    #[inline(always)]
    fn is_near(&self, center: DVec3, reach: f64) -> bool {
        Descent::new(&self.levels, center, reach).next().is_some()
    }

    #[inline(always)]
    fn push(&self, state: &mut PatchState, center: DVec3, reach: f64) {
        for tile in Descent::new(&self.levels, center, reach) {
            self.push_tile(state, tile, center, reach);
        }
    }
}

/// The tiles that a sphere is near, ascending.
struct Descent<'a> {
    levels: &'a [Vec<Balls>],
    center: DVec3,
    reach: f64,
    /// The level that is looked at.
    level: usize,
    /// The block of each level down to it, and which of its balls are still to come.
    blocks: [(usize, Below); MOST_LEVELS],
}

impl<'a> Descent<'a> {
    #[inline(always)]
    fn new(levels: &'a [Vec<Balls>], center: DVec3, reach: f64) -> Self {
        let mut blocks = [(0, Below::default()); MOST_LEVELS];
        blocks[0].1 = levels[0][0].near(center, reach);
        Self {
            levels,
            center,
            reach,
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
            self.blocks[self.level] = (ball, below[ball].near(self.center, self.reach));
        }
    }
}

impl Tile {
    fn new(taxels: &[(DVec3, DVec3)]) -> Self {
        let nowhere = (DVec3::splat(FAR), DVec3::X);
        let of = |value| filled(taxels, &nowhere, value);
        Self {
            centers: [
                of(|(center, _)| center.x),
                of(|(center, _)| center.y),
                of(|(center, _)| center.z),
            ],
            axes: [
                of(|(_, axis)| axis.x),
                of(|(_, axis)| axis.y),
                of(|(_, axis)| axis.z),
            ],
        }
    }
}
