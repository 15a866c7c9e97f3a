//! Study: TOML → plan → table.

pub mod table;
