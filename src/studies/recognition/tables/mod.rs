//! Result tables, computed from the scores of trials.

pub mod published;
pub mod summary;
pub mod tabulate;
pub mod variance_table;
