//! Scenes of the command `simulate`, and studies of human touch.

#[path = "../fixtures/arrays/mod.rs"]
mod arrays;
#[path = "../fixtures/command/mod.rs"]
mod command;
#[path = "../../crates/bubbletouch-sim/tests/laws/fixtures/reference_data.rs"]
mod reference_data;
#[path = "../fixtures/scene/mod.rs"]
mod scene;
#[path = "../fixtures/recording/mod.rs"]
mod stored;

mod human_touch;
mod layout_files;
mod layout_formats;
mod projected;
mod scene_by_hand;
mod scene_forces;
mod scene_laws;
mod scene_meshes;
mod scene_mounts;
mod scene_robots;
mod scene_signal;
mod scene_starts;
