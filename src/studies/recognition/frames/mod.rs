//! Frames of all touches of an array: simulated once, used by all configurations, and stored in memory.

pub(crate) mod frame_store;
pub mod human_touches;
pub(crate) mod pressed_objects;
pub mod reading;
pub(crate) mod recorded_array;
pub mod recorded_frames;
pub(crate) mod recorded_labels;
pub mod recorded_skin;
pub mod samples;
pub(crate) mod sensor_frames;
pub(crate) mod shear_ripple;
pub mod touch_set;

pub use self::{
    frame_store::*, human_touches::*, pressed_objects::*, reading::*, recorded_array::*,
    recorded_frames::*, recorded_labels::*, recorded_skin::*, samples::*, sensor_frames::*,
    shear_ripple::*, touch_set::*,
};
