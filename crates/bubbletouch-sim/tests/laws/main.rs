//! Laws of the simulation, each checked against a slow or an independent computation.

mod fixtures {
    pub mod cases;
    pub mod counting;
    pub mod double_double;
    pub mod every_part;
    pub mod mesh_shapes;
    pub mod overlapping;
    pub mod reference_data;
    pub mod scans;
    pub mod scenes;
    pub mod shapes;
    pub mod time_loop;
}
mod contact;
mod objects;
mod sensing;
mod world;

use bubbletouch_sim::statistics::standard_errors;
use fixtures::{
    cases, counting, double_double, every_part, mesh_shapes, overlapping, reference_data, scans,
    scenes, shapes, time_loop,
};
