//! Formats of mesh files, and the unit of their numbers.
//!
//! | format | unit | content |
//! |---|---|---|
//! | PLY, OBJ, STL | none: metres, unless the user gives another | polygons |
//! | Collada (`.dae`) | `<unit meter="…">` | polygons, in the frames of a tree of nodes |
//! | glTF (`.glb`, `.gltf`) | metres | triangles, in the frames of a tree of nodes |
//!
//! The up axis of a Collada or glTF file is not converted: coordinates are as written, as in RViz and Gazebo. The transforms of nodes are applied, and
//! polygons in a mirrored node are turned, so that they face outwards as in their own frame.

mod base64;
mod collada;
mod gltf;
mod gltf_file;
mod joined_parts;
mod mesh_format;
mod obj;
mod ply;
mod stl;
mod text_lines;

pub use collada::read_collada;
pub use gltf::read_gltf;
pub use mesh_format::{LengthUnit, MeshFormat};
pub use obj::{obj_group, read_obj};
pub use ply::read_ply;
pub use stl::read_stl;
