//! Every kind of study, and long runs: kill and resume, shards, merge, job arrays, and readers of corrupted files.

#[path = "../fixtures/browser/mod.rs"]
mod browser;
#[path = "../fixtures/command/mod.rs"]
mod command;
#[path = "../../crates/bubbletouch-sim/tests/laws/fixtures/counting.rs"]
mod counting;
#[path = "../fixtures/faults/mod.rs"]
mod faults;
#[path = "../fixtures/fuzzing/mod.rs"]
mod fuzzing;
#[path = "../fixtures/kinds/mod.rs"]
mod kinds;
#[path = "../fixtures/study/mod.rs"]
mod study;

mod every_key;
mod every_kind;
mod fuzz;
mod hostile;
mod pieces;
mod resume;
mod slurm;
