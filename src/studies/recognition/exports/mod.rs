//! Export of frames and features to files for other programs.

pub mod feature_files;
pub mod touch_files;

pub use self::{feature_files::*, touch_files::*};
