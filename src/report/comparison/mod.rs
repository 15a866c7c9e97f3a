//! Comparison of two result folders.
//!
//! The inputs are the tables of both folders. The outputs are rows and columns that differ (`changes`), differences of values with their significance
//! (`differences`), and the agreement of both rankings of designs (`rank_agreement`). `compared` reports these results as text and as a page.

pub mod changes;
pub mod compared;
pub mod differences;
pub mod rank_agreement;
