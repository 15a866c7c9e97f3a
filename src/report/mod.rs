//! Report: tables → files for people.

pub mod files;
