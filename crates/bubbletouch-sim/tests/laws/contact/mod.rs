//! Contact: indentation, force, friction, damping, balance, meshes and skins.

mod approach;
mod balance;
mod balance_limits;
mod dynamics_laws;
mod force;
mod free_mesh_forces;
mod free_meshes;
mod friction;
mod held;
mod laws;
mod limits;
mod many_bodies;
mod mesh;
mod mesh_at_pose;
mod mesh_sequences;
mod press_numbers;
mod press_variants;
mod reference_scenes;
mod rounded;
mod skin_layouts;
mod skin_meshes;
mod skins;
mod slide;
mod suite;
