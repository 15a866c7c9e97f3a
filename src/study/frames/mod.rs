//! The frames of an array's touches: made once, read by every cell, and kept in memory.

mod kept;
mod making;

pub(crate) use bubbletouch_sim::frame_coding::most_bytes;
pub use kept::Frames;

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
