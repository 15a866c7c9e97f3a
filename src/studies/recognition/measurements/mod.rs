//! Measurements of frames, and features made of them.

pub mod images;
pub mod measurement;
pub mod measurement_inputs;
pub mod tilted_copies;
