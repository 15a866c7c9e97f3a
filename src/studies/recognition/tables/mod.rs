//! Tables of scores.

pub mod published;
pub mod summary;
pub mod tabulate;
pub mod variance_table;
