//! Contact: indentation, force, friction, damping, balance, meshes and skins.

mod approach;
mod balance;
mod balance_limits;
mod closed_forms;
mod dynamics_laws;
mod force;
mod free_mesh_forces;
mod free_meshes;
mod friction;
mod held;
mod limits;
mod many_bodies;
mod press_numbers;
mod reference_scenes;
mod skin_layouts;
mod slide;
mod suite;
