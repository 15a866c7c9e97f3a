//! Splits and configurations of a study.

pub mod configurations;
pub mod splits;

pub use self::{configurations::*, splits::*};
