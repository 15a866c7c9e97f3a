//! The audit finds no fault in clean sets of many kinds and designs, and finds each planted fault under its own name.

mod clean;
mod laws;
mod level;
mod plants;
mod sets;
mod structures;
