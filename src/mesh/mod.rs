//! Meshes: a file of triangles → distances, inside and outside, and what is wrong with it.
//!
//! | from | by | gives |
//! |---|---|---|
//! | a PLY, OBJ or STL file | [`MeshFormat::read`] | a [`MeshFile`]: corners and polygons as written, in metres |
//! | a [`MeshFile`] | [`MeshFile::into_mesh`] | a [`TriangleMesh`] |
//! | a [`TriangleMesh`] | [`MeshReport::new`] | what is wrong with it: holes, flipped or degenerate faces |
//! | a [`TriangleMesh`] | [`Surface::new`] | nearest points, signed distances, winding numbers |
//!
//! For a point x outside the mesh the signed distance is positive, inside it is negative:
//!
//! ```text
//! d(x) = ± min_y |x − y|,   y on a triangle
//! ```
//!
//! On a closed mesh the sign is that of `(x − y)·n`, n the angle-weighted pseudonormal of the face, edge or vertex that y
//! lies on \[BA\]: exact if the mesh does not cut through itself. On a mesh with holes x is inside where
//! the generalised winding number exceeds one half \[GWN\], summed over a tree of dipoles
//! \[FWN\]. Nothing is repaired here.

mod box_tree;
mod box_tree_build;
mod bvh;
mod format;
mod measures;
mod mesh_file;
mod obj;
mod ply;
mod pseudonormals;
mod report;
mod size_limits;
mod slab;
mod stl;
mod surface;
mod triangle;
mod triangle_mesh;
mod welded;
mod winding;

pub use box_tree::BoxTree;
pub use bvh::{Bvh, Closest, Hit};
pub use format::{LengthUnit, MeshFormat};
pub use mesh_file::MeshFile;
pub use obj::read_obj;
pub use ply::read_ply;
pub use report::MeshReport;
pub use size_limits::SizeLimits;
pub use stl::read_stl;
pub use surface::Surface;
pub use triangle::{Feature, Triangle};
pub use triangle_mesh::TriangleMesh;
pub use welded::{Side, Welded};
