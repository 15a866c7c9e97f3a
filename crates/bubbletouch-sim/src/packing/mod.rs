//! Sphere packing: a mesh and a tolerance → a union of few spheres.
//!
//! | from | by | gives |
//! |---|---|---|
//! | a [`Surface`](crate::mesh::Surface) and a tolerance e | [`pack_mesh`] | a [`Packing`] |
//! | several tolerances | [`DetailChain::pack`] | the same object, coarse to fine |
//! | a mesh and a number | [`medial_spheres`] | the largest inside spheres that touch it at so many points: to compare with |
//! | a mesh and spheres | [`packing_error`] | how far apart they are, both ways |
//!
//! # The promise
//!
//! The *solid* of a mesh is where its [winding number](crate::mesh#the-solid-of-a-mesh) exceeds one half: of closed parts that
//! overlap it is their union. The *outer surface* is its boundary (that of cavities too); faces that look into the solid are
//! none of it, nor are clefts narrower than a thousandth of the tolerance e.
//!
//! Let d(c) be the distance of a point c of the solid to the nearest face, buried ones included: a ball of that radius lies in
//! the solid. The sphere (c, d + e/2) reaches at most e/2 outside it, and is within e of exactly those points that are within
//! **d + 3e/2** of c. So
//!
//! - **protrusion**: no point of a sphere is more than e/2 outside the solid, by construction, whatever spheres are chosen
//!   (that c lies in the solid is asked of each exactly, by counting what a ray crosses);
//! - **gap**: no point of the outer surface is more than e outside the spheres, by proof: a ball that holds the corners of
//!   a triangle holds all of it, so triangles are halved until each piece is held by one ball, or proved to look into the
//!   solid all over (`certificate`). What cannot be proved is an error.
//!
//! It is not promised that the two surfaces are within e of each other everywhere: spheres may close clefts narrower than e,
//! and leave hollows inside the solid where nothing touches.
//!
//! Thin walls, edges and tips need no care of their own: a ball around a point of the surface (d = 0) always holds what is
//! within 3e/2 of it.
//!
//! Spheres that reached all of e outside would be fewest, but the middle of their surface would lie e/2 outside the mesh; with
//! half of it outside, their bumps and hollows about cancel, and the skin's error halves for a third more spheres (`ball`).
//!
//! # The method
//!
//! 1. `sampling`: samples of the surface, denser where balls are small; and at many feet the **largest ball inside** the
//!    mesh that touches it there, found by shrinking \[MBC\]. Balls that leave a slack for bumps were tried and are worse:
//!    what they give up in depth they lose in reach.
//! 2. `cover_surface`: cell by cell few of these balls that cover all samples: greedy, then a local search with row
//!    weights \[RWLS\] (`set_cover`), which saves a fifth to a quarter of greedy's spheres. Then again with other cells, with
//!    balls beside the chosen ones, and with samples wherever the proof found a gap.
//! 3. Where gaps are left balls are added until there is none.
//!
//! # How few?
//!
//! Let h = 3e/2. On a flat face a ball of depth d holds a disc of radius `a = sqrt(h(2d + h))`; in the best covering of the
//! plane by discs each has `(3√3/2)·a² ≈ 2.6·h(2d + h)` to itself, so a face needs its area over that. Along a sharp
//! right-angled edge the best ball has d = h and holds 2√2·h of the edge, so an edge needs its length over 2.8·h. Walls
//! thinner than the rest of the object have small balls on both sides at once and cost most.
//!
//! # Sources
//!
//! - `[MBC]` Ma, Bae, Choi, *3D medial axis point approximation using nearest neighbors and the normal field*, 2012.
//! - `[RWLS]` Gao, Weise, Li, *An efficient local search heuristic with row weighting for the unicost set covering
//!   problem*, 2015.
//! - Before: Bradshaw & O'Sullivan, *Adaptive medial-axis approximation for sphere-tree construction*, 2004; Wang et al.,
//!   *Variational sphere set approximation for solid objects*, 2006; Stolpner, Kry, Siddiqi, *Medial spheres for shape
//!   approximation*, 2011. They give an error for a number of spheres; here the error is given.

mod ball;
#[cfg(test)]
mod brick;
mod cells;
mod certificate;
mod cover_surface;
mod detail_chain;
mod medial_spheres;
mod pack;
mod packing_error;
mod sampling;
mod set_cover;
mod target;

pub use detail_chain::DetailChain;
pub use medial_spheres::medial_spheres;
pub use pack::{Packing, error_of_file, pack_mesh, pack_mesh_watched, slow_packing};
pub use packing_error::{PackingError, Spread, packing_error};
pub use target::Body;
