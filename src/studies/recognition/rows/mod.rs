//! The rows of the result tables of a recognition study.

pub mod conditions;
pub mod configuration;
pub mod row_inputs;
pub mod table_rows;

pub use self::{conditions::*, configuration::*, row_inputs::*, table_rows::*};
