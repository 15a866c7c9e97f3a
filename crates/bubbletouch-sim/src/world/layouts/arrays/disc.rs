//! Disc: a hexagonal lattice of taxels inside a circle.

use super::about::LayoutAbout;
use super::lattice::NEIGHBOUR;
use crate::world::Layout;
use std::f64::consts::PI;

pub const ABOUT: LayoutAbout = LayoutAbout {
    neighbour_pitches: Some(NEIGHBOUR),
    ..LayoutAbout::new("hexagonal disc", |grid, _| {
        let side = grid.nx as f64 * grid.pitch;
        Layout::disc(side / PI.sqrt(), NEIGHBOUR * grid.pitch)
    })
};
