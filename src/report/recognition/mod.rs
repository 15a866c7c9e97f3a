//! What a study of recognition shows of its tables: charts, sentences, and what its page has beside those of any study.

mod answers;
mod charts;
mod sections;
mod tables;

use crate::table::Table;

pub use answers::{answers, words};
pub use charts::charts;
pub use sections::sections;
pub use tables::{CELLS, TABLE_NAMES, read_tables, tables_of};

/// A table that has rows, by its file.
fn filled<'a>(tables: &'a [Table], file: &str) -> Option<&'a Table> {
    let mut tables = tables.iter();
    tables.find(|table| table.file == file && table.n_rows > 0)
}
