//! Specification of a recognition study: the keys of its TOML file.

pub mod classifier_parameters;
pub mod foreign;
pub mod human;
pub mod keys;
pub mod pose_split;
pub mod recorded;
pub mod recorded_sensor;
pub mod scene;
pub mod signal;
pub mod study;
mod used_sensors;
pub mod zero;
