//! Tables in text files, as studies read them.

use crate::errors::{exception, guarded};
use bubbletouch::inputs::arrays::{Table, column_families as families};
use pyo3::prelude::*;
use std::path::Path;

/// Table in a text file: the names of its columns, the cells of each column, the numbers of the columns that do not count the rows, and notes.
type ReadTable = (
    Option<Vec<String>>,
    Vec<Vec<String>>,
    Vec<usize>,
    Vec<String>,
);

/// Reads a table in a text file. Returns the names of its columns, or None without a header; the cells of each column; the numbers of the columns that do
/// not count the rows; and notes on what was left out. Raises ValueError if the lines differ in the number of cells.
#[pyfunction]
pub fn read_table(path: &str) -> PyResult<ReadTable> {
    guarded(|| {
        let table = Table::read(Path::new(path), None).map_err(exception)?;
        let owned = |column: Vec<&str>| column.into_iter().map(str::to_owned).collect();
        let columns = table.columns().into_iter().map(owned).collect();
        let kept = table.without_index();
        Ok((table.names, columns, kept, table.notes))
    })
}

/// Returns a list of the families of columns, and the pattern of the largest family; None if all names differ in numbers alone.
#[pyfunction]
pub fn column_families(names: Vec<String>) -> Option<(String, String)> {
    families(&names)
}
