//! Pictures: vector drawings, and raster pictures of frames, spheres and objects.

pub mod colours;
pub mod drawing;
pub mod fit_picture;
pub mod frame_files;
pub mod heat_map;
pub mod layout_picture;
pub mod object_picture;
pub(crate) mod picture;
pub(crate) mod picture_axes;
pub mod pressure_map;
pub mod snapshots;

pub use colours::{GRID, INK, LINES, MUTED, PAPER, Rgb, diverging, heat, text_on, tint};
pub use drawing::{Align, Area, Drawing, Point, Stroke, TextStyle, escape};
pub use heat_map::{ColourScale, check_frame, largest_of_blocks};
pub use picture::Picture;

pub(crate) use colours::PAINT;
pub(crate) use heat_map::{block_sentence, grid_sentence};
pub(crate) use picture::unfit;
pub(crate) use picture_axes::{
    Side, draw_axis, draw_colour_bar, draw_colours, draw_map_axis, draw_scale_bar, even_ticks,
    round_up, tick_step,
};
