//! The resting pose of a free object: where the taxels that it presses carry it.
//!
//! Without friction the forces of the taxels are −∇ of their elastic energy, so an object is at rest where
//! `E = Σ ½ k δ² − m g·x` is stationary, and stays there where it is a minimum \[BT\]. [`Balancer::settle`] goes down from a
//! pose by a trust-region Newton method with closed-form derivatives: never uphill, and out of saddles, too, since negative
//! curvature is followed. What finds no minimum leaves the skins: it [escapes](Outcome::Escaped).
//!
//! Two things make E rough, and both are kept exactly: a taxel between two spheres (`tied_max`), and the rigid stop of a
//! taxel at its stroke. Both are constraints with multipliers: the shares of the spheres, and the force of the stop.
//!
//! Where both are so many, or springs so unlike, that this does not get there, an interior-point method ends it (`finish`): there the
//! forces are unknowns of their own.
//!
//! # Sources
//!
//! - `[MS]` Moré, Sorensen, *Computing a trust region step*, 1983.
//! - `[RW]` Rockafellar, *Augmented Lagrangians and applications of the proximal point algorithm in convex programming*, 1976.

mod descent;
mod energy;
mod fall;
mod finish;
mod free_object;
mod graded_rows;
mod interior;
mod loads;
mod model;
mod pairs;
mod reach;
mod settle;
mod six;
mod tied_max;

pub use free_object::{FreeObject, PlacedSkin};
pub use settle::{Balance, Balancer, Outcome, TaxelLoad};
