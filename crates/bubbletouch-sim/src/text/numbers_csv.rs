//! Numbers in CSV files that people write: how they are read, and what is said of a row that cannot be.

use crate::error::{Error, Result};
use std::io::{self, Read};

/// A reader of rows of any length, blanks around fields dropped, no row taken for a header.
pub fn rows_of<R: Read>(source: R) -> csv::Reader<R> {
    csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(source)
}

/// The error of a file that cannot be read or is no text; `allowed` says what its rows are.
pub fn unreadable(place: &str, error: csv::Error, allowed: impl ToString) -> Error {
    let text = error.to_string();
    match error.into_kind() {
        csv::ErrorKind::Io(source) if source.kind() != io::ErrorKind::InvalidData => {
            Error::unreadable(place, &allowed.to_string(), source)
        }
        _ => Error::input(place, text, allowed),
    }
}

/// The line that a row begins in, from 1.
pub fn line_of(record: &csv::StringRecord) -> u64 {
    record.position().map_or(0, |position| position.line())
}

/// The error is another number of fields in a row at `place`.
///
/// # Errors
/// The record has another number of fields.
pub fn check_width(place: &str, record: &csv::StringRecord, width: usize) -> Result<()> {
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
///
/// # Errors
/// The field is no finite number.
pub fn finite(place: &str, column: &str, field: &str, allowed: &str) -> Result<f64> {
    match field.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(Error::input(
            format!("{place}, column {column}"),
            format!("`{field}`"),
            allowed,
        )),
    }
}

/// A header of names, and rows that have a number under each.
#[derive(Debug, Default)]
pub struct NumberTable {
    /// The file's name, for errors.
    pub place: String,
    header_line: u64,
    /// The names of the columns.
    pub names: Vec<String>,
    /// One a name.
    pub columns: Vec<Vec<f64>>,
    /// Where each row is in the file.
    pub lines: Vec<u64>,
}

impl NumberTable {
    /// Reads all; errors begin with `place`, the file's name, and give line and column. `allowed`: what such a file has.
    ///
    /// # Errors
    /// The file is no table of finite numbers.
    pub fn read(place: &str, source: impl Read, allowed: &str) -> Result<Self> {
        let not_text = |error| unreadable(place, error, allowed);
        let mut reader = rows_of(source);
        let mut records = reader.records();
        let Some(header) = records.next().transpose().map_err(not_text)? else {
            return Err(Error::input(place, "an empty file", allowed));
        };
        let names: Vec<String> = header.iter().map(str::to_owned).collect();
        let mut table = Self {
            place: place.to_owned(),
            header_line: line_of(&header),
            columns: vec![Vec::new(); names.len()],
            names,
            lines: Vec::new(),
        };
        for record in records {
            let record = record.map_err(not_text)?;
            let place = format!("{place}, line {}", line_of(&record));
            check_width(&place, &record, table.names.len())?;
            let cells = record.iter().zip(&table.names);
            for ((cell, name), column) in cells.zip(&mut table.columns) {
                column.push(finite(&place, name, cell, "a finite number")?);
            }
            table.lines.push(line_of(&record));
        }
        Ok(table)
    }

    /// An error in the header.
    pub fn refuse_header(&self, given: impl ToString, allowed: impl ToString) -> Error {
        let place = format!("{}, line {}", self.place, self.header_line);
        Error::input(place, given, allowed)
    }

    /// Where a column is, by its name.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known == name)
    }
}
