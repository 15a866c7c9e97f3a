//! Studies that recognise: tables, memory, repeatability.

#[path = "../fixtures/command/mod.rs"]
mod command;
use bubbletouch_sim::standard_errors;
#[path = "../fixtures/study/mod.rs"]
mod study;

mod accuracy;
mod axes;
mod calibration;
mod experiments;
mod families;
mod frames;
mod generated;
mod hardware;
mod images;
mod intervals;
mod laws;
mod layouts;
mod memory;
mod next_touch;
mod pose_splits;
mod quickstart;
mod readings;
mod recorded;
mod recorded_arrays;
mod recorded_law;
mod repeatability;
mod sensor_error_names;
mod shear;
mod variance;
