//! Equilibrium of free objects on taxels, tables, obstacles and each other.
//!
//! Without friction the forces of the taxels are −∇ of their elastic energy. Objects are therefore at rest where `E = Σ ½ k δ² − Σ m g·x` is stationary, and
//! stable where E has a minimum \[BT\]. All objects form one problem with six unknowns each, since δ is the largest deflection that any object requires. The
//! solver ([`EquilibriumSolver`]) minimises E from the initial poses by a trust-region Newton method with closed-form derivatives. The energy never
//! increases, and the method leaves saddles because it follows negative curvature. If the energy has no minimum for an object, the object leaves the skins
//! ([escaped](Outcome::Escaped)), and the solver continues with the other objects.
//!
//! The energy E has three kinds of kinks, all of which are kept exactly by constraints with multipliers:
//!
//! - Taxels between two spheres of one object or of two (`tied_max`). The multipliers are the shares of the spheres.
//! - Hard limits of taxels at the end of their stroke. The multipliers are the forces of these limits.
//! - Rigid contacts with half-spaces ([`HalfSpace`]), fixed objects ([`Obstacle`]), and other free objects. The multipliers are the contact forces.
//!
//! An object is a union of spheres or a triangle mesh ([`RigidShape`]). The parts of a mesh are its faces, edges and corners. A taxel touches the part that is
//! nearest to its stopped ball; two meshes touch at corners and faces, and where ridges cross (`meshes`). Where the nearest part changes, the energy has a kink
//! only in a valley of the mesh, and the valley's faces share the force as spheres do.
//!
//! A damper delays its taxel. Within a step Δt a free taxel returns to φ δ_before (φ = e^(−k Δt / c)); beyond this deflection its stiffness is k / (1 − φ). The
//! energy within a step is therefore E = Σ ½ k/(1 − φ) (δ − φ δ_before)², and its forces equal the damped forces in
//! [`DamperState`](crate::contact::DamperState).
//!
//! With friction, the shear springs of the taxels that touched an object at the beginning of the step also act on this object (`shear_springs`).
//!
//! # Sources
//!
//! - `[MS]` Moré, Sorensen, *Computing a trust region step*, 1983.
//! - `[NJ]` Nečas, Jarušek, Haslinger, *On the solution of the variational inequality to the Signorini problem with small friction*, 1980.
//! - `[RW]` Rockafellar, *Augmented Lagrangians and applications of the proximal point algorithm in convex programming*, 1976.

mod algebra;
mod body;
mod curvature;
mod descent;
mod energy;
mod fall;
mod free_object;
mod loads;
mod meshes;
mod model;
mod pair;
mod pairs;
mod reach;
mod reports;
mod rigid_contact;
mod rigid_pairs;
mod rigid_shape;
mod scene;
mod shear_springs;
mod slopes;
mod solver;
mod stagnation;
mod symmetric;
#[cfg(test)]
mod tests;
mod tied_max;

pub use super::friction::{TangentialSpring, TangentialSpringState};
pub use free_object::{FreeObject, Ground, HalfSpace, Obstacle, PlacedSkin};
pub use meshes::overlap;
pub use reports::{RigidContact, TaxelLoad};
pub use rigid_contact::Touched;
pub use rigid_shape::RigidShape;
pub use solver::{Equilibrium, EquilibriumSolver, Outcome};
