//! Inputs that studies and scenes share: objects, arrays of numbers, and keys with their checks.

pub mod arrays;
pub(crate) mod check;
pub mod content_hash;
pub(crate) mod doc_comment;
pub mod keys;
pub mod layout_file;
pub mod memory;
pub mod npy;
pub mod object_files;
pub mod objects_spec;
pub mod packings;
pub mod params;
pub mod range;
pub mod sensor_errors;
pub(crate) mod toml_value;
pub(crate) mod units;
