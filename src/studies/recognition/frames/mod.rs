//! The frames of an array's touches: made once, read by every cell, and kept in memory.

pub mod array_press;
pub mod human_samples;
pub mod human_touches;
pub(crate) mod kept;
pub(crate) mod making;
pub mod reading;
pub mod recorded_frames;
pub mod recorded_skin;
pub mod samples;
pub(crate) mod shear_ripple;
pub mod simulation;
pub mod touch_set;

pub use crate::studies::recognition::frames::kept::Frames;

/// What happened while frames were made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameFacts {
    /// F, frames a touch.
    pub n_frames: usize,
    /// Touches that met nothing: no taxel is deflected when they are deepest.
    pub n_missed: usize,
    /// Touches with at least one taxel at its stroke when they are deepest.
    pub n_saturated: usize,
    /// Processor-seconds, summed over threads.
    pub cpu_s: f64,
}
