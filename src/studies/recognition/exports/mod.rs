//! Frames and features in files for other programs.

pub mod feature_files;
pub mod touch_files;
