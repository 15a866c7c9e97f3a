//! The command and its outputs: subcommands, bad input, pages, charts, pictures and recordings.

#[path = "../fixtures/arrays/mod.rs"]
mod arrays;
#[path = "../fixtures/browser/mod.rs"]
mod browser;
#[path = "../fixtures/chart_tables/mod.rs"]
mod chart_tables;
#[path = "../fixtures/command/mod.rs"]
mod command;
#[path = "../../crates/bubbletouch-sim/tests/laws/fixtures/counting.rs"]
mod counting;
#[path = "../../crates/bubbletouch-sim/tests/laws/fixtures/reference_data.rs"]
mod reference_data;
#[path = "../fixtures/report_synthetic/mod.rs"]
mod report_synthetic;
#[path = "../fixtures/browser/shown.rs"]
mod shown;
#[path = "../fixtures/recording/mod.rs"]
mod stored;
#[path = "../fixtures/study/mod.rs"]
mod study;

mod audit;
mod calibrate;
mod classify;
mod events;
mod features;
mod instructions;
mod outputs;
mod own_objects;
mod page;
mod press;
mod printed_numbers;
mod readme;
mod recording;
mod results;
mod sessions;
mod simulate;
mod touches;
mod wrong_recordings;
