//! Measurements of frames, and features computed from them.

pub mod images;
pub mod measurement;
pub mod measurement_inputs;

pub use self::{images::*, measurement::*, measurement_inputs::*};
