//! Objects: meshes, solids, catalogues and packings.

#[path = "../fixtures/mesh_shapes/mod.rs"]
mod mesh_shapes;
#[path = "../fixtures/overlapping/mod.rs"]
mod overlapping;
#[path = "../fixtures/random_scenes/mod.rs"]
mod random_scenes;
#[path = "../fixtures/reference_data/mod.rs"]
mod reference_data;

mod catalogue;
mod files;
mod mesh_files;
mod mesh_surface;
mod orientation;
mod packing;
mod packing_laws;
mod solids;
