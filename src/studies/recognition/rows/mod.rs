//! The rows of the result tables of a recognition study.

pub mod conditions;
pub mod configuration;
pub mod image_features;
pub mod row_inputs;
pub mod table_rows;
