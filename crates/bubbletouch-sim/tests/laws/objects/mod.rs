//! Objects: meshes, solids, catalogues and packings.

mod catalogue;
mod centre_of_mass;
mod files;
mod mesh_files;
mod mesh_scene_files;
mod mesh_surface;
mod orientation;
mod packing_laws;
mod primitives;
mod solids;
