//! Meshes: reads files of triangles, computes distances and inside or outside, and reports faults.
//!
//! | from | by | gives |
//! |---|---|---|
//! | a PLY, OBJ, STL, Collada or glTF file | [`MeshFormat::read`] | a [`MeshFile`]: corners and polygons as written, in metres |
//! | the sizes of a box, cylinder, ellipsoid or capsule | [`TriangleMesh::cuboid`] … | a [`TriangleMesh`] |
//! | a [`MeshFile`] | [`MeshFile::into_mesh`] | a [`TriangleMesh`] |
//! | a [`TriangleMesh`] | [`TriangleMesh::turned_outwards`] | the mesh with closed parts outwards, and an [`Orientation`] |
//! | a [`TriangleMesh`] | [`MeshReport::new`] | its faults: holes, flipped or degenerate faces |
//! | a [`TriangleMesh`] | [`Surface::new`] | nearest points, signed distances, winding numbers |
//!
//! The signed distance of a point x is positive outside the mesh and negative inside:
//!
//! ```text
//! d(x) = ± min_y |x − y|,   y on a triangle
//! ```
//!
//! On a closed mesh the sign equals the sign of `(x − y)·n`, where n is the angle-weighted pseudonormal at y \[BA\]. The sign is exact if the mesh does not
//! intersect itself.
//!
//! # The solid of a mesh
//!
//! A point x is in the solid of a mesh if its winding number exceeds one half. If every edge has equally many faces in both directions, this number is an
//! integer. Counting the crossings of a ray then gives the exact number (`crossings`). The solid of closed parts that overlap is then their union. A part
//! that faces inwards is a cavity in the part around it. Faces that coincide back to back cancel. On a mesh with holes the generalised winding number
//! \[GWN\] is used, summed over a tree of dipoles \[FWN\], with an error of about 0.1.
//!
//! Readers do not repair meshes. [`TriangleMesh::with_holes_closed`] closes holes, [`TriangleMesh::turned_outwards`] turns triangles.

mod box_tree;
mod bvh;
mod crossings;
mod enclosed;
mod features;
mod formats;
mod holes;
mod mesh_file;
mod orientation;
pub(crate) mod primitives;
mod pseudonormals;
mod report;
mod size_limits;
mod surface;
mod triangle;
mod triangle_mesh;
mod welded;
mod winding;

#[doc(hidden)]
pub use box_tree::BoxTree;
pub use bvh::{Bvh, Closest, RayHit};
pub(crate) use features::CREASE;
pub use features::{Edge, Face, MeshFeatures};
pub use formats::{LengthUnit, MeshFormat, obj_group};
#[doc(hidden)]
pub use formats::{read_collada, read_gltf, read_obj, read_ply, read_stl};
pub use holes::{ClosedHoles, Hole};
pub use mesh_file::MeshFile;
pub use orientation::Orientation;
pub use report::MeshReport;
pub use size_limits::SizeLimits;
pub use surface::Surface;
pub use triangle::{MeshFeature, Triangle};
pub use triangle_mesh::TriangleMesh;
pub use welded::{EdgeSide, Welded};
