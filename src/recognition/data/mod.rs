//! Labelled rows: which train and which test, on which scale, of which features, and what is wrong with them.

pub mod dataset;
pub mod features;
pub mod over_time;
pub mod scaling;
pub mod split;
pub mod spoiled;
