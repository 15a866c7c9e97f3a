//! Result tables, computed from the scores of trials.

pub(crate) mod chance;
pub mod published;
pub(crate) mod robustness;
pub mod summary;
pub(crate) mod table_files;
pub mod tabulate;
pub mod variance_table;
