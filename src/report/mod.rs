//! Reports, which present result tables as charts, pages and text.
//!
//! The inputs are the result tables with their chart specifications, frames (ny × nx, metres or newtons), and the metadata of the study. The outputs are CSV
//! files, charts and pictures (SVG and PNG), terminal text, and one self-contained HTML page. Equal inputs give equal bytes. Each file is written completely or
//! not at all.
//!
//! [`study_folder::files_with`] returns the files of a result folder. [`terminal::table_text`] returns the table that is printed after a run.
//! [`frame_files::write_frame`] and [`pressure_map`] output a single frame. [`recording`] writes frames over time to a file and draws them as pictures or
//! animations.

pub mod advice;
pub mod chart;
pub mod comparison;
pub mod csv_tables;
pub mod folder;
pub mod page;
pub mod pictures;
pub mod progress;
pub mod recording;
pub mod scene_files;
pub mod study_folder;
pub mod swept;
pub mod terminal;
pub mod text_width;

pub use pictures::{
    colours, drawing, fit_picture, frame_files, heat_map, layout_picture, object_picture,
    pressure_map, snapshots,
};
