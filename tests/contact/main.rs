//! Contact: indentation, force, friction, damping, balance, meshes and skins against laws and slow oracles.

#[path = "../fixtures/counting/mod.rs"]
mod counting;
#[path = "../fixtures/double_double/mod.rs"]
mod double_double;
#[path = "../fixtures/mesh_shapes/mod.rs"]
mod mesh_shapes;
#[path = "../fixtures/random_scenes/mod.rs"]
mod random_scenes;
#[path = "../fixtures/reference_data/mod.rs"]
mod reference_data;

mod approach;
mod balance;
mod balance_limits;
mod dynamics_laws;
mod force;
mod friction;
mod held;
mod laws;
mod limits;
mod many_bodies;
mod mesh;
mod press_variants;
mod reference_scenes;
mod skin_layouts;
mod skin_meshes;
mod skins;
mod slide;
mod suite;
