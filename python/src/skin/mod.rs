//! Class `Skin`: readings of several patches under several bodies in one call, for the loop of a simulator.
//!
//! - `skin_class`: the class with its arguments and results;
//! - `contact_loads`: contact forces of an engine as arguments;
//! - `shear_state`: the class `ShearState`, shear springs with friction between successive reads;
//! - `poses`: poses as arguments.

mod contact_loads;
mod poses;
mod shear_state;
mod skin_class;

pub use shear_state::ShearState;
pub use skin_class::Skin;
