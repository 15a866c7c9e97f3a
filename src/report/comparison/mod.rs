//! Comparison of two result folders.
//!
//! In: the tables of both. Out: rows and columns that differ (`entries`), differences of values with their significance (`differences`),
//! the agreement of both rankings of designs (`rank_agreement`), and all of this as text and as a page (`compared`).

pub mod compared;
pub mod differences;
pub mod entries;
pub mod rank_agreement;
