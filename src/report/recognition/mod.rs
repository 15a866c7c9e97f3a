//! What a study of recognition shows of its tables: charts, sentences, and what its page has beside those of any study.

mod answers;
mod charts;
mod sections;
mod tables;

pub use answers::{answers, words};
pub use charts::{charts, is_wanted};
pub use sections::sections;
pub use tables::{CELLS, read_tables, tables_of};
pub(super) use tables::{costs_table, say};

use crate::report::swept::Swept;
use crate::table::Table;

/// Settings that follow from others are given up in this order: m and the ratio say the same twice at one array; the array's sides follow
/// its pitch when nx stays. One that a study can only choose directly is dropped last.
const GIVEN_UP_FIRST: [&str; 16] = [
    "nx",
    "ny",
    "measurements",
    "ratio",
    "size_mm",
    "pitch_mm",
    "c",
    "train_touches",
    "mislabelled_fraction",
    "class_imbalance",
    "fused_touches",
    "smoothing_mm",
    "noise_std",
    "frames",
    "over_time",
    "features",
];

/// The settings of cells, by whether they vary.
pub(super) fn swept<'a>(cells: &'a Table, rows: &[usize]) -> Swept<'a> {
    Swept::of(cells, rows, &GIVEN_UP_FIRST)
}
