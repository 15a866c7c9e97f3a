//! Readers of files meet hostile bytes.

#[path = "../fixtures/counting/mod.rs"]
mod counting;
#[path = "../fixtures/fuzzing/mod.rs"]
mod fuzzing;
#[path = "../fixtures/study/mod.rs"]
mod study;

mod fuzz;
