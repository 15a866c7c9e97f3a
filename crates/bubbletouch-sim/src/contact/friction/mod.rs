//! Friction: tangential springs and Coulomb's cone at the taxels.

mod coulomb;
mod state;
mod tangential_spring;

pub use state::{ContactMode, ContactModeCounts, FrictionLoad, FrictionState, NormalForce};
pub use tangential_spring::{TangentialSpring, TangentialSpringState};
