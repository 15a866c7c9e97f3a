//! The other kinds of study, each end to end.

#[path = "../fixtures/command/mod.rs"]
mod command;
#[path = "../fixtures/kinds/mod.rs"]
mod kinds;
#[path = "../fixtures/mesh_shapes/mod.rs"]
mod mesh_shapes;
use bubbletouch_sim::standard_errors;

mod asked;
mod breaking_points;
mod object_detail;
mod reconstruction;
mod speed_accuracy;
mod stability;
mod whole_body;
