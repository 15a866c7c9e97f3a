//! Report: tables → files for people.

pub mod files;
pub mod object_picture;
mod shaded_view;
