//! Patch on any surface: tiles of taxels, each taxel with its own axis.
//!
//! Taxels are stored in tiles of eight, in the order of their layout. Each tile has a bounding ball; so have eight consecutive tiles, eight of those groups,
//! and so on. A press descends this tree of balls to the tiles near a sphere.

use super::lanes::{Balls, FAR, LANES, ball_around, filled};
use crate::objects::Sphere;
use crate::world::Layout;
use glam::DVec3;

/// Number of taxels in a block, for which one range of touched taxels is stored.
pub(super) const BLOCK: usize = LANES * LANES;

/// Equal taxels at arbitrary positions; patch and state together need 61 bytes per taxel.
#[derive(Clone, Debug)]
pub(super) struct DrapedPatch {
    pub n_taxels: usize,
    /// Height of the substrate relative to the taxels' centres at rest, metres.
    pub behind: f64,
    pub tiles: Vec<Tile>,
    /// Bounding balls of the search tree, level by level. The first level is one block of at most eight balls. Ball k bounds block k of the next level; on
    /// the last level ball k bounds tile k.
    pub levels: Vec<Vec<Balls>>,
    /// Ball around all taxels (their centres at rest and the substrate below them), in the patch frame.
    pub ball: Sphere,
}

/// Tile of eight neighbouring taxels, stored coordinate by coordinate. The last tile is padded with taxels far away.
#[derive(Clone, Debug)]
pub(super) struct Tile {
    /// Centres of the taxels at rest: x, y, z, metres.
    pub centers: [[f64; LANES]; 3],
    /// Axes of the taxels: x, y, z, unit vectors.
    pub axes: [[f64; LANES]; 3],
}

impl DrapedPatch {
    /// Creates a patch of at least one taxel, with the substrate at the height `behind`, metres.
    pub fn new(layout: &Layout, behind: f64) -> Self {
        let taxels = layout.centers().iter().copied();
        let taxels: Vec<_> = taxels.zip(layout.axes().iter().copied()).collect();
        // Segment of a taxel, from the rest centre back to the substrate.
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

    /// Returns the layout of the patch, in the order of the taxels.
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

    /// Returns the heap memory that the patch uses in bytes.
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
