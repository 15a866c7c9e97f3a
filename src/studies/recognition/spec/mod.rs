//! A recognition study as its TOML file states it.

pub mod human;
pub mod pose_split;
pub mod recorded;
pub mod scene;
pub mod signal;
pub mod study;
