//! Tables with roles: what a study yields, and all that a report, a page, advice and a comparison look at.
//!
//! Rows stay typed structs, one field a column; [`row!`](crate::row) makes struct and columns of one list, in which each field says its words,
//! unit, scale and [`Role`]: one of which nothing is said does not compile. [`File`] knows what a table is before
//! there are rows: it makes the table of rows, and reads that of a file that a run wrote; both hold the same.
//! A [`ChartSpec`] names the columns of a table that a chart shows; it holds no pixels.

mod chart;
mod column;
mod file;
mod front;
mod value;
use bubbletouch_sim::text::numbers;
mod row_macro;
mod rows;
#[allow(clippy::module_inception)]
mod table;

pub use chart::{Along, At, ChartSpec, Mark, Rule, Shown};
pub use column::{Better, Column, Columns, Role, Scale, column_name};
pub use file::File;
pub use front::front;
pub use numbers::{short_number, time_words};
pub(crate) use table::csv_place;
pub use table::{Data, Table};
pub use value::Value;
