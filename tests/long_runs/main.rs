//! Long runs: kill and resume, shards, merge, job arrays.

#[path = "../fixtures/command/mod.rs"]
mod command;
#[path = "../fixtures/faults/mod.rs"]
mod faults;
#[path = "../fixtures/kinds/mod.rs"]
mod kinds;

mod hostile;
mod pieces;
mod resume;
mod slurm;
