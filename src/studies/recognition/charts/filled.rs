//! Search for a result table by file name; tables without rows are ignored.

use crate::table::Table;

/// Returns the table with the given file name; `None` if there is no such table or if it has no rows.
pub(crate) fn filled<'a>(tables: &'a [Table], file: &str) -> Option<&'a Table> {
    let mut tables = tables.iter();
    tables.find(|table| table.file == file && table.n_rows > 0)
}
