//! Meshes: a file of triangles → distances, inside and outside, and what is wrong with it.
//!
//! | from | by | gives |
//! |---|---|---|
//! | a PLY, OBJ or STL file | [`MeshFormat::read`] | a [`MeshFile`]: corners and polygons as written, in metres |
//! | a [`MeshFile`] | [`MeshFile::into_mesh`] | a [`TriangleMesh`] |
//! | a [`TriangleMesh`] | [`TriangleMesh::turned_outwards`] | the mesh with closed parts outwards, and an [`Orientation`] |
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
//! lies on \[BA\]: exact if the mesh does not cut through itself.
//!
//! # The solid of a mesh
//!
//! x is in the solid of a mesh if its winding number exceeds one half. Where every edge is passed as often in one direction as
//! in the other, that number is whole, and found exactly by counting what a ray crosses (`crossings`): of closed parts that
//! overlap the solid is their union, a part that faces inwards is a cavity in what holds it, and faces that lie on each
//! other back to back are none. On a mesh with holes it is the generalised winding number \[GWN\], summed over a
//! tree of dipoles \[FWN\], right within about 0.1.
//!
//! Readers repair nothing. [`TriangleMesh::with_holes_closed`] closes holes, [`TriangleMesh::turned_outwards`] turns triangles.

mod box_tree;
mod box_tree_build;
mod bvh;
mod crossings;
mod format;
mod holes;
mod measures;
mod mesh_file;
mod obj;
mod obj_group;
mod orientation;
mod ply;
mod pseudonormals;
mod report;
mod separation;
mod size_limits;
mod slab;
mod stl;
mod surface;
mod text_lines;
mod triangle;
mod triangle_mesh;
mod welded;
mod winding;

pub use box_tree::BoxTree;
pub use bvh::{Bvh, Closest, Hit};
pub use format::{LengthUnit, MeshFormat};
pub use holes::{ClosedHoles, Hole};
pub use mesh_file::MeshFile;
pub use obj::read_obj;
pub use obj_group::obj_group;
pub use orientation::Orientation;
pub use ply::read_ply;
pub use report::MeshReport;
pub use size_limits::SizeLimits;
pub use stl::read_stl;
pub use surface::Surface;
pub use triangle::{Feature, Triangle};
pub use triangle_mesh::TriangleMesh;
pub use welded::{Side, Welded};
