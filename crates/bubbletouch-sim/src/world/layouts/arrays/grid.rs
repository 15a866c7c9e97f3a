//! Grid: rows and columns of taxels.

use super::about::LayoutAbout;
use crate::world::Layout;

pub const ABOUT: LayoutAbout = LayoutAbout {
    sides: |grid| Some(grid.shape()),
    is_image: true,
    ..LayoutAbout::new("square grid", |grid, _| Layout::grid(grid))
};
