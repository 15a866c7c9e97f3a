//! Sphere packing: approximates a mesh by a union of few spheres within a tolerance.
//!
//! | from | by | gives |
//! |---|---|---|
//! | a [`Surface`](crate::mesh::Surface) and a tolerance e | [`pack_mesh`] | a [`Packing`] |
//! | a mesh and a number of points | [`medial_spheres`] | the largest inside spheres that touch the mesh at these points, for comparison |
//! | a mesh and spheres | [`packing_error`] | the distances between their surfaces, in both directions |
//!
//! # The promise
//!
//! The *solid* of a mesh is the region where its [winding number](crate::mesh#the-solid-of-a-mesh) exceeds one half. If closed parts
//! overlap, the solid is their union. The *outer surface* is its boundary, including the boundaries of cavities. Faces inside the solid
//! do not belong to the outer surface; clefts narrower than a thousandth of the tolerance e are ignored.
//!
//! Let d(c) be the distance of a point c of the solid to the nearest face, buried faces included. The ball of radius d around c lies in
//! the solid. The sphere (c, d + e/2) reaches at most e/2 outside it, and is within e of exactly those points that are within
//! **d + 3e/2** of c. Two properties follow:
//!
//! - **protrusion**: no point of a sphere is more than e/2 outside the solid. This holds by construction for any choice of spheres. Whether c lies in the solid
//!   is tested exactly, by counting the crossings of a ray.
//! - **gap**: no point of the outer surface is more than e outside the spheres. The proof uses that a ball that contains the corners of a triangle contains the
//!   whole triangle. Triangles are halved until one ball contains each piece, or until a piece is proved to lie inside the solid (`certificate`). If the proof
//!   fails, packing returns an error.
//!
//! The two surfaces need not be within e of each other everywhere. Spheres may close clefts narrower than e, and may leave hollows inside the solid, where
//! nothing touches.
//!
//! Thin walls, edges and thin ends need no special treatment. A ball around a surface point (d = 0) always contains the surface within 3e/2 of this point.
//!
//! Spheres that reach a full e outside would be fewest, but the middle of their surface would lie e/2 outside the mesh. With
//! e/2 outside, bumps and hollows nearly cancel, and the error of the deflections halves for a third more spheres (`ball`).
//!
//! # The method
//!
//! 1. `sampling`: places samples on the surface, more densely where balls are small. At many surface points it computes the
//!    **largest ball inside** the mesh that touches the point, by shrinking \[MBC\]. Balls with a slack for bumps were tried and are worse:
//!    the smaller depth reduces the area that they cover.
//! 2. `cover_surface`: chooses, cell by cell, few balls that cover all samples. A greedy choice is followed by a local search with row
//!    weights \[RWLS\] (`set_cover`), which removes a fifth to a quarter of the spheres. The choice is repeated with other cells, with
//!    balls beside the chosen ones, and with new samples where the proof found a gap.
//! 3. `cover_surface` adds balls at the remaining gaps until there is none.
//!
//! # How many spheres?
//!
//! Let h = 3e/2. On a flat face a ball of depth d covers a disc of radius `a = sqrt(h(2d + h))`. In the best covering of the plane by discs the area per
//! disc is `(3√3/2)·a² ≈ 2.6·h(2d + h)`. A face needs its area divided by this value. Along a sharp right-angled edge, the best ball has d = h and covers
//! 2√2·h of the edge. The number of balls on an edge is therefore its length divided by 2.8·h. Thin walls have small balls on both sides at once and need
//! the most spheres.
//!
//! # Sources
//!
//! - `[MBC]` Ma, Bae, Choi, *3D medial axis point approximation using nearest neighbors and the normal field*, 2012.
//! - `[RWLS]` Gao, Weise, Li, *An efficient local search heuristic with row weighting for the unicost set covering
//!   problem*, 2015.
//! - Earlier work: Bradshaw & O'Sullivan, *Adaptive medial-axis approximation for sphere-tree construction*, 2004; Wang et al.,
//!   *Variational sphere set approximation for solid objects*, 2006; Stolpner, Kry, Siddiqi, *Medial spheres for shape
//!   approximation*, 2011. These methods minimise the error for a given number of spheres; here the error is given.

mod ball;
#[cfg(test)]
mod brick;
mod cells;
mod certificate;
mod cover_surface;
mod medial_spheres;
mod pack;
mod packing_error;
mod sampling;
mod set_cover;
mod target;

pub use medial_spheres::medial_spheres;
pub use pack::{Packing, error_of_file, pack_mesh, pack_mesh_watched, slow_packing};
pub use packing_error::{DistanceStatistics, PackingError, packing_error};
pub use target::Body;
