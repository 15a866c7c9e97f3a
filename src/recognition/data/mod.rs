//! Labelled rows: which train and which test, on which scale, and what is wrong with them.

pub mod dataset;
pub mod over_time;
pub mod scaling;
pub mod split;
pub mod spoiled;
