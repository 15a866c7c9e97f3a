//! The command and its outputs: subcommands, bad input, pages, charts, pictures and recordings.

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
mod bad_input;
mod calibrate;
mod classify;
mod events;
mod features;
mod instructions;
mod layout;
mod mesh;
mod outputs;
mod own_command;
mod own_objects;
mod page;
mod paths;
mod press;
mod printed_numbers;
mod readme;
mod recording;
mod report;
mod shell;
mod simulate;
mod surface;
mod touches;
mod wrong_recordings;
