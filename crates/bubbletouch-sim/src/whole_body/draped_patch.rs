//! A patch on any surface: tiles of taxels that each have their own axis.
//!
//! The taxels are kept eight by eight in the order of their layout. Balls are around these tiles, around eight tiles that follow each
//! other, around eight of those, and so on: a sphere goes down to the tiles that it is near.

use super::lanes::{Balls, FAR, LANES, ball_around, filled};
use crate::objects::Sphere;
use crate::world::Layout;
use glam::DVec3;

/// Taxels whose touched span is remembered together.
pub(super) const BLOCK: usize = LANES * LANES;

/// Equal taxels that rest anywhere: 61 bytes each with what is remembered of them.
#[derive(Clone, Debug)]
pub(super) struct DrapedPatch {
    pub n_taxels: usize,
    /// Height of the substrate, metres.
    pub behind: f64,
    pub tiles: Vec<Tile>,
    /// The first level is one block of at most eight balls; a ball of a level is around the block of its number of the next one, and of
    /// the last level around a tile.
    pub levels: Vec<Vec<Balls>>,
    /// Around all taxels from their rest centres back to the substrate, in the patch frame.
    pub ball: Sphere,
}

/// Eight taxels, coordinate by coordinate. The last one is filled up with some far away.
#[derive(Clone, Debug)]
pub(super) struct Tile {
    /// Rest centres: x, y, z, metres.
    pub centers: [[f64; LANES]; 3],
    /// Axes: x, y, z.
    pub axes: [[f64; LANES]; 3],
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
