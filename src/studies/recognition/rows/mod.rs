//! The rows of the result tables of a recognition study.

pub mod cell;
pub mod conditions;
pub mod image_features;
pub mod row_inputs;
pub mod table_rows;
