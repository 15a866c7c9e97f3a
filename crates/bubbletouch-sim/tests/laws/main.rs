//! Laws of the simulation, each checked against a slow or an independent computation.

mod fixtures {
    pub mod counting;
    pub mod double_double;
    pub mod mesh_shapes;
    pub mod overlapping;
    pub mod random_scenes;
    pub mod reference_data;
    pub mod scans;
    pub mod shapes;
    pub mod time_loop;
}
mod contact;
mod objects;
mod sensing;
mod world;

use bubbletouch_sim::statistics::standard_errors;
use fixtures::{
    counting, double_double, mesh_shapes, overlapping, random_scenes, reference_data, scans,
    shapes, time_loop,
};
