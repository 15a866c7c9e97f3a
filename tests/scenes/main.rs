//! The world: placement, robots, scenes, human touch and whole bodies.

#[path = "../fixtures/command/mod.rs"]
mod command;
#[path = "../fixtures/counting/mod.rs"]
mod counting;
#[path = "../fixtures/random_scenes/mod.rs"]
mod random_scenes;
#[path = "../fixtures/reference_data/mod.rs"]
mod reference_data;
use bubbletouch_sim::standard_errors;
#[path = "../fixtures/recording/mod.rs"]
mod stored;

mod human_touch;
mod placement_rest;
mod placement_touches;
mod robot_motion;
mod robot_public_files;
mod robot_urdf;
mod scene_by_hand;
mod scene_cut;
mod scene_errors;
mod scene_forces;
mod scene_laws;
mod scene_mounts;
mod scene_robots;
mod scene_signal;
mod scene_starts;
mod whole_body_laws;
mod whole_body_variants;
