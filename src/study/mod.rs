//! Study: TOML → plan → table.

pub mod progress;
pub mod table;
