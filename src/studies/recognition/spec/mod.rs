//! Specification of a recognition study: the keys of its TOML file.

pub mod classifier_parameters;
pub mod foreign;
pub mod keys;
pub mod pose_split;
pub mod recorded;
pub mod recorded_sensor;
pub mod scene;
pub mod signal;
pub mod study;

pub use self::{
    classifier_parameters::*, foreign::*, keys::*, pose_split::*, recorded::*, recorded_sensor::*,
    scene::*, signal::*, study::*,
};
