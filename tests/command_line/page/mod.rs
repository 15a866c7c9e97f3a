//! Output files for readers: page, charts, pictures and recordings.

mod asked;
mod charts;
mod everywhere;
mod pareto;
mod pictures;
mod recording_files;
mod recording_pictures;
mod rows;
mod study_page;
mod tables;
mod two_folders;
mod whole_page;
