//! Reader of result tables in CSV files.
//!
//! Floating-point numbers have the shortest form that reads back as the same bits, so that equal tables have equal bytes. An absent value is an empty field. A
//! table without rows has a header without the optional columns.

use crate::error::{Error, Result};
use crate::table::csv_place;
use serde::de::DeserializeOwned;
use std::path::Path;

/// File name of the table of failed work items.
pub const FAILURES_FILE: &str = "failures.csv";

/// File name of the table that counts how often each limit of the simulation and of the solver was reached.
pub const LIMITS_FILE: &str = "limits.csv";
/// Name of the row in [`LIMITS_FILE`] that counts the touches without any touched taxel.
pub const MISSED_TOUCHES: &str = "touches that met nothing";
/// Name of the row in [`LIMITS_FILE`] that counts the trained classifiers whose solver stopped at its iteration cap.
pub const CAPPED_FITS: &str = "fits stopped at the solver's iteration cap";

/// Description of a valid table file, for error messages.
const A_TABLE: &str = "a table of results as bubbletouch run writes it";

/// Reads the rows of a table from a CSV file.
///
/// # Errors
/// If the file cannot be read or has invalid rows; the error contains the file and the line.
pub fn read_rows<R: DeserializeOwned>(path: &Path) -> Result<Vec<R>> {
    let file = crate::files::open(path).map_err(|e| Error::unreadable(path, A_TABLE, e))?;
    csv::Reader::from_reader(file)
        .into_deserialize()
        .map(|row| row.map_err(|e| read_error(path, e)))
        .collect()
}

fn read_error(path: &Path, error: csv::Error) -> Error {
    let place = csv_place(path, error.position().map(csv::Position::line));
    let said = error.to_string();
    match error.into_kind() {
        csv::ErrorKind::Io(source) => Error::unreadable(path, A_TABLE, source),
        _ => Error::input(place, said, "a result table with this version's columns"),
    }
}
