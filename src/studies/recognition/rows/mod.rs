//! The rows of the result tables of a recognition study.

pub mod configuration;
pub mod table_rows;

pub use self::{configuration::*, table_rows::*};
