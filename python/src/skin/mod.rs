//! `Skin`: several patches read under several bodies at once, as a simulator's loop needs them.
//!
//! - `skin_class`: the class, its arguments and results;
//! - `parts`: patches and bodies, and the press of a patch under bodies at their poses;
//! - `force_match`: the press of a pair until its normal force is a given one;
//! - `shear_state`: the class `ShearState`, shear springs with friction between successive reads;
//! - `poses`, `filled`: poses as arguments, and arrays of the caller that are filled.

mod filled;
mod force_match;
mod parts;
mod poses;
mod shear_state;
mod skin_class;

pub use shear_state::ShearState;
pub use skin_class::Skin;
