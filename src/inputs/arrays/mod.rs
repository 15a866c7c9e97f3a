//! Reading of array files: `.npy`, members of `.npz`, and `.csv`. All NumPy element types for numbers and texts are supported.
//!
//! In a `.npz` archive, the member with the requested name (`frames`, `labels`, …) is read, or its only member. A `.csv` file is a table of rows and columns.
//! Elements are converted to f64 (integers exactly below 2⁵³), or kept as texts in UTF-8, UTF-16 or Latin-1.

pub(crate) mod axis_order;
pub(crate) mod column_names;
pub(crate) mod csv_table;
mod file_array;
pub(crate) mod npy_file;
pub(crate) mod whole_numbers;

pub use self::axis_order::{FrameAxes, FrameShape, frame_shape};
pub use self::column_names::column_families;
pub use self::csv_table::{Table, TableContent};
pub use self::file_array::*;
pub use self::whole_numbers::{ClassLabels, KeyValue, OneForEach, group_keys, read_rows};
