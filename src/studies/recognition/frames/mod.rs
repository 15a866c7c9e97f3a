//! Frames of all touches of an array: simulated once, used by all configurations, and stored in memory.

pub(crate) mod frame_store;
pub mod human_touches;
pub(crate) mod pressed_objects;
pub mod reading;
pub mod recorded_frames;
pub mod recorded_skin;
pub mod samples;
pub(crate) mod sensor_frames;
pub(crate) mod shear_ripple;
pub(crate) mod touch_lengths;
pub mod touch_set;

pub(crate) use self::touch_lengths::*;
pub use self::{
    frame_store::*, human_touches::*, pressed_objects::*, reading::*, recorded_frames::*,
    recorded_skin::*, samples::*, sensor_frames::*, shear_ripple::*, touch_set::*,
};
