//! Frames of all touches of an array: simulated once, used by all configurations, and stored in memory.

pub mod array_press;
pub(crate) mod frame_store;
pub mod human_samples;
pub(crate) mod human_touch_set;
pub mod human_touches;
pub(crate) mod parallel_simulation;
pub(crate) mod pressed_objects;
pub mod reading;
pub mod recorded_frames;
pub mod recorded_skin;
pub mod samples;
pub(crate) mod sensor_frames;
pub(crate) mod shear_ripple;
pub mod simulation;
pub(crate) mod touch_lengths;
pub mod touch_set;

pub use crate::studies::recognition::frames::frame_store::Frames;
