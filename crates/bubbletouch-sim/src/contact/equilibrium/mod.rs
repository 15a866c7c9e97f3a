//! Equilibrium of free objects on taxels, tables, obstacles and each other.
//!
//! Without friction the forces of the taxels are −∇ of their elastic energy, so objects are at rest where
//! `E = Σ ½ k δ² − Σ m g·x` is stationary, and stay there where it is a minimum \[BT\]: one problem of six unknowns an object, since δ is
//! the largest that any of them needs. [`EquilibriumSolver::solve_all`] goes down from their poses by a trust-region Newton method with
//! closed-form derivatives: never uphill, and out of saddles, too, since negative curvature is followed. What finds no minimum leaves:
//! it [escapes](Outcome::Escaped), and the others go on without it.
//!
//! Three things make E rough, and all are kept exactly: a taxel between two spheres (`tied_max`), be they of one object or of two; the
//! rigid stop of a taxel at its stroke; and what is rigid itself, which spheres do not enter: half-spaces ([`HalfSpace`]), objects that
//! do not move ([`Obstacle`]), and the spheres of other free objects. They are constraints with multipliers: the shares of the spheres, and
//! the forces of stops and touches.
//!
//! A damper holds its taxel in: within a step of Δt it comes out to φ δ at most (φ = e^(−k Δt / c)), and what pushes it further finds a spring
//! of k / (1 − φ) from there on. So in a step E = Σ ½ k/(1 − φ) (δ − φ δ_before)², and the forces are those of
//! [`DamperState`](crate::contact::DamperState).
//!
//! A skin with friction holds by shear springs, too: those of the taxels that touched an object when the step began (`shear_springs`).
//!
//! # Sources
//!
//! - `[MS]` Moré, Sorensen, *Computing a trust region step*, 1983.
//! - `[NJ]` Nečas, Jarušek, Haslinger, *On the solution of the variational inequality to the Signorini problem with small friction*, 1980.
//! - `[RW]` Rockafellar, *Augmented Lagrangians and applications of the proximal point algorithm in convex programming*, 1976.

mod body;
mod descent;
mod energy;
mod fall;
mod free_object;
mod loads;
mod model;
mod pair;
mod pairs;
mod reach;
mod reports;
mod rigid_contact;
mod rigid_pairs;
mod scene;
mod shear_springs;
mod slopes;
mod solver;
mod symmetric;
mod tied_max;

pub use super::friction::{TangentialSpring, TangentialSpringState};
pub use free_object::{FreeObject, Ground, HalfSpace, Obstacle, PlacedSkin};
pub use reports::{TaxelLoad, Touch};
pub use rigid_contact::Touched;
pub use solver::{Equilibrium, EquilibriumSolver, Outcome};
