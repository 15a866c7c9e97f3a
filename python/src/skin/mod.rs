//! Class `Skin`: readings of several patches under several bodies in one call, for the loop of a simulator.
//!
//! - `skin_class`: the class with its arguments and results;
//! - `parts`: patches and bodies, and the press of a patch under bodies at their poses;
//! - `contact_loads`: contact forces of an engine, and the patch on which each contact acts;
//! - `force_match`: the press of a pair of patch and object to a given normal force;
//! - `shear_state`: the class `ShearState`, shear springs with friction between successive reads;
//! - `poses`, `filled`: poses as arguments, and arrays of the caller that are filled.

mod contact_loads;
mod filled;
mod force_match;
mod parts;
mod poses;
mod shear_state;
mod skin_class;

pub use shear_state::ShearState;
pub use skin_class::Skin;
