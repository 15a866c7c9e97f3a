//! The command: every subcommand, bad input, the README.

#[path = "../fixtures/command/mod.rs"]
mod command;
#[path = "../fixtures/reference_data/mod.rs"]
mod reference_data;
#[path = "../fixtures/recording/mod.rs"]
mod stored;
#[path = "../fixtures/study/mod.rs"]
mod study;

mod bad_input;
mod calibrate;
mod classify;
mod events;
mod features;
mod instructions;
mod mesh;
mod outputs;
mod paths;
mod press;
mod readme;
mod recording;
mod report;
mod shell;
mod simulate;
mod surface;
mod touches;
mod unused;
