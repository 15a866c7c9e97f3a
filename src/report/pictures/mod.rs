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
