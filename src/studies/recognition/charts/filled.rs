//! Tables that have rows.

use crate::table::Table;

/// A table that has rows, by its file.
pub(crate) fn filled<'a>(tables: &'a [Table], file: &str) -> Option<&'a Table> {
    let mut tables = tables.iter();
    tables.find(|table| table.file == file && table.n_rows > 0)
}
