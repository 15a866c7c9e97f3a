//! Report: tables → files for people.
//!
//! In: the result tables ([`Tables`](crate::study::table::Tables)), frames (ny × nx, metres or newtons), and what the study
//! says of itself ([`ReportPage`](page::ReportPage)). Out: CSV files, charts and pictures (SVG and PNG), terminal text, and
//! one self-contained HTML page. Equal input gives equal bytes; every file is whole or not there.
//!
//! [`results::write_all`] writes a study's folder; [`terminal::summary_table`] is what a run prints at its end;
//! [`frame_files::write_frame`] and [`pressure_map`] show a single frame; [`recording`] streams frames over time to a file and
//! draws them, also moving.

pub mod axis;
pub(crate) mod canvas;
pub mod chart;
pub mod colours;
mod csv_header;
pub mod csv_tables;
pub mod drawing;
pub mod fit_picture;
pub mod folder;
pub mod frame_files;
mod headlines;
pub mod heat_map;
mod legend;
mod log_scale;
pub mod object_picture;
pub mod offers;
pub mod page;
mod panels;
pub(crate) mod picture;
pub mod pressure_map;
pub mod progress;
pub mod progress_json;
mod raster;
pub mod recognition;
mod recognition_tables;
pub mod recording;
pub mod results;
pub mod run_clock;
pub mod run_differences;
pub mod scene_files;
pub mod scene_summary;
pub(crate) mod shaded_view;
mod signal_axis;
pub mod snapshots;
pub mod study_folder;
pub mod study_tables;
pub mod swept;
pub mod terminal;
pub mod text_width;
mod time_scale;
pub mod varying;
mod x_scale;
