//! Studies of every kind from file to results, and the classifiers that they train.

#[path = "../fixtures/chart_tables/mod.rs"]
mod chart_tables;
#[path = "../fixtures/command/mod.rs"]
mod command;
#[path = "../fixtures/kinds/mod.rs"]
mod kinds;
#[path = "../../crates/bubbletouch-sim/tests/laws/fixtures/mesh_shapes.rs"]
mod mesh_shapes;
#[path = "../fixtures/study/mod.rs"]
mod study;
use bubbletouch_sim::statistics::standard_errors;

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
mod kept_packings;
mod keys;
mod kinds_of_study;
mod laws;
mod layouts;
mod memory;
mod next_touch;
mod pose_splits;
mod predictions;
mod public_sets;
mod quickstart;
mod readings;
mod recognition;
mod recorded;
mod refusals;
mod repeatability;
mod sensor_error_names;
mod shear;
mod taxels;
mod test_touches;
mod unused_keys;
mod variance;
