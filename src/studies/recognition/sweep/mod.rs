//! Splits and configurations of a study.

pub mod configurations;
pub mod splits;
pub mod training_rows;

pub use self::{configurations::*, splits::*, training_rows::*};
