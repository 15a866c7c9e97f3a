//! Result tables of a study, from which reports, pages, advice and comparisons are made. Each column has a role.
//!
//! Rows are typed structs with one field per column. The macro `row!` defines the struct and its columns together. Each field has a display name, a unit, a
//! scale and a [`Role`]. A field without a role does not compile. [`File`] specifies a table independently of its rows. A table created from rows equals the
//! table that is read from the file of the same run. [`ChartSpec`] names the columns of a table that a chart shows; it contains no pixels.

mod chart;
mod column;
mod file;
mod front;
use bubbletouch_sim::text::numbers;
mod row_macro;
mod rows;
#[allow(clippy::module_inception)]
mod table;

pub use chart::{Along, At, ChartSpec, Dot, Mark, Rule, Shown};
pub use column::{Better, Column, Columns, Role, Scale, column_name};
pub use file::{File, FileAbout};
pub use front::front;
pub use numbers::{short_number, time_words};
pub(crate) use table::csv_place;
pub use table::{Data, Table, Value};
