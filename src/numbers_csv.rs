//! Numbers in CSV files that people write: how they are read, and what is said of a row that cannot be.

use crate::error::{Error, Result};
use std::io::{self, Read};

/// A reader of rows of any length, blanks around fields dropped, no row taken for a header.
pub(crate) fn rows_of<R: Read>(source: R) -> csv::Reader<R> {
    csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(source)
}

/// The error of a file that cannot be read or is no text; `allowed` says what its rows are.
pub(crate) fn unreadable(place: &str, error: csv::Error, allowed: impl ToString) -> Error {
    let text = error.to_string();
    match error.into_kind() {
        csv::ErrorKind::Io(source) if source.kind() != io::ErrorKind::InvalidData => {
            Error::unreadable(place, &allowed.to_string(), source)
        }
        _ => Error::input(place, text, allowed),
    }
}

/// The line that a row begins in, from 1.
pub(crate) fn line_of(record: &csv::StringRecord) -> u64 {
    record.position().map_or(0, |position| position.line())
}

/// The error is another number of fields in a row at `place`.
pub(crate) fn check_width(place: &str, record: &csv::StringRecord, width: usize) -> Result<()> {
    if record.len() == width {
        return Ok(());
    }
    Err(Error::input(
        place,
        format!("{} columns", record.len()),
        format!("{width} columns in every row"),
    ))
}

/// The finite number that a field of a row at `place` is; `allowed` says what of.
pub(crate) fn finite(place: &str, column: &str, field: &str, allowed: &str) -> Result<f64> {
    match field.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(Error::input(
            format!("{place}, column {column}"),
            format!("`{field}`"),
            allowed,
        )),
    }
}
