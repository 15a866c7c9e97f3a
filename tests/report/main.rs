//! What people look at: page, charts, pictures, recordings.

#[path = "../fixtures/browser/mod.rs"]
mod browser;
#[path = "../fixtures/chart_tables/mod.rs"]
mod chart_tables;
#[path = "../fixtures/command/mod.rs"]
mod command;
#[path = "../fixtures/counting/mod.rs"]
mod counting;
#[path = "../fixtures/kinds/mod.rs"]
mod kinds;
#[path = "../fixtures/report_synthetic/mod.rs"]
mod report_synthetic;
#[path = "../fixtures/recording/mod.rs"]
mod stored;

mod asked;
mod charts;
mod every_kind;
mod everywhere;
mod page;
mod pareto;
mod pictures;
mod recording_files;
mod recording_pictures;
mod rows;
mod study_page;
mod tables;
mod two_folders;
