//! Dynamics: a skin whose taxels have mass, with common time integrators, as a reference for the quasi-static model.
//!
//! A taxel i of mass m moves by `m δ̈ + c δ̇ + k δ = f − s`. Here f ≥ 0 is the force of the object, and s ≥ 0 the force of the stop at the stroke. The
//! object is on a **guide**: it moves only along the taxels' common axis, by its travel x. An object of any shape pushes taxel i to the deflection `x − a`,
//! where a is the travel at first contact with the taxel. The object is either free under gravity, `M ẍ = M g − Σ f`, or its motion is imposed ([`Drive`]).
//!
//! | integrator | contact | damper and spring | breaks |
//! |---|---|---|---|
//! | [`SemiImplicit`] | penalty, f = κ (x − a − δ) | damper implicit, spring explicit | beyond Δt > 2 √(m / (k + κ)), less for light objects |
//! | [`ImplicitEuler`] | exact: 0 ≤ f ⟂ gap ≥ 0 at the step's end | both implicit | never; its accuracy in time is of order Δt |
//! | `RapierWorld` (feature `rapier`) | contact model of the engine | joint motors of the engine | if the engine's iterations do not converge |
//!
//! Balls can be stacked on the object, with free motion on the same guide.
//!
//! All three integrators implement [`Integrator`]. The function [`run`] performs the steps and returns a [`DynamicRecording`], which contains the frames of the
//! contact stage. The function [`rest`] computes the common final state, where the springs carry the weight.
//!
//! Not modelled: rotation and lateral motion of the object, friction, and a stop at zero deflection. A free taxel can therefore swing to negative deflections.
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
pub use recording::{Divergence, DynamicRecording, SimulatedRecording, Steps, run};
pub use rest::{Rest, rest};
pub use semi_implicit::SemiImplicit;
pub use state::{Integrator, Rider, State};
pub use system::{Drive, System};
