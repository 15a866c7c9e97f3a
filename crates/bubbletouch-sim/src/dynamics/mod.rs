//! Dynamics: what the quasi-static model is measured against. A skin whose taxels have mass, stepped as people step it.
//!
//! For taxel i of mass m: `m δ̈ + c δ̇ + k δ = f − s`, with f ≥ 0 the push of the object and s ≥ 0 that of the stop at the stroke.
//! The object is on a **guide**: it moves along the taxels' common axis only, by its travel x, as a plunger does. So taxel i is
//! pushed as far as `x − a`, where a is the travel at which they meet ([`System::starts`]), for every shape of object. It is free
//! under gravity, `M ẍ = M g − Σ f`, or its motion is imposed ([`Drive`]).
//!
//! | integrator | contact | damper and spring | breaks |
//! |---|---|---|---|
//! | [`SemiImplicit`] | penalty, f = κ (x − a − δ) | damper implicit, spring explicit | beyond Δt > 2 √(m / (k + κ)), less for light objects |
//! | [`ImplicitEuler`] | exact: 0 ≤ f ⟂ gap ≥ 0 at the step's end | both implicit | never; its accuracy in time is of order Δt |
//! | `RapierWorld` (feature `rapier`) | the engine's | the engine's joint motors | what the engine cannot solve in its iterations |
//!
//! Balls may be [stacked](System::stacked) on the object, free on the same guide.
//!
//! All are an [`Integrator`]; [`run`] steps one and gives a [`DynamicRecording`], whose [`Recording`](crate::contact::Recording) is that of
//! the contact stage: everything downstream takes it. [`rest`] is where all of them must end: the springs carry the weight.
//!
//! What is not modelled: an object that turns or moves aside, friction, and a stop on the way out (a free taxel swings through 0).
//!
//! # Sources
//!
//! - `[SK]` Habib et al., *SkinSim: a simulation environment for multimodal robot skin*, CASE 2014: [`skin_sim`].
//! - `[AP]` Anitescu, Potra, *Formulating dynamic multi-rigid-body contact problems with friction as solvable linear complementarity
//!   problems*, 1997: implicit Euler with exact contact, which never gains energy.

mod implicit_euler;
#[cfg(feature = "rapier")]
mod rapier_settings;
#[cfg(feature = "rapier")]
mod rapier_world;
mod recording;
mod rest;
mod semi_implicit;
pub mod skin_sim;
mod state;
mod system;

pub use implicit_euler::ImplicitEuler;
#[cfg(feature = "rapier")]
pub use rapier_settings::{RapierContacts, RapierJoints, RapierSettings};
#[cfg(feature = "rapier")]
pub use rapier_world::RapierWorld;
pub use recording::{Divergence, DynamicRecording, Steps, run};
pub use rest::{Rest, rest};
pub use semi_implicit::SemiImplicit;
pub use state::{Integrator, Rider, State};
pub use system::{Drive, System};
