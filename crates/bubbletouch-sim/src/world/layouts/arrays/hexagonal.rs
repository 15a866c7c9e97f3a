//! Hexagonal lattice: staggered rows of taxels.

use super::about::LayoutAbout;
use super::lattice::{NEIGHBOUR, sides};
use crate::world::ImageShape;
use crate::world::Layout;

pub const ABOUT: LayoutAbout = LayoutAbout {
    sides: |grid| Some(sides(grid.nx)),
    neighbour_pitches: Some(NEIGHBOUR),
    ..LayoutAbout::new("hexagonal", |grid, _| {
        let ImageShape {
            ny: rows,
            nx: columns,
        } = sides(grid.nx);
        Layout::hexagonal(columns, rows, NEIGHBOUR * grid.pitch)
    })
};
