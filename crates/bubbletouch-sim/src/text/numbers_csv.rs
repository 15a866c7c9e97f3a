//! Reading of numbers from CSV files, and the errors of invalid rows.

use super::numbers::finite_number;
use crate::error::{Error, Result};
use std::io::Read;

/// Returns a CSV reader for rows of any length, without a header; blanks around fields are removed.
pub fn rows_of<R: Read>(source: R) -> csv::Reader<R> {
    csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(source)
}

/// Returns the error of a file that cannot be read or is not text; `allowed` describes valid rows.
pub fn unreadable(place: &str, error: csv::Error, allowed: impl ToString) -> Error {
    let text = error.to_string();
    match error.into_kind() {
        csv::ErrorKind::Io(source) => Error::unreadable(place, &allowed.to_string(), source),
        _ => Error::input(place, text, allowed),
    }
}

/// Returns the line at which a row begins, counted from 1.
pub fn line_of(record: &csv::StringRecord) -> u64 {
    record.position().map_or(0, |position| position.line())
}

/// Returns an error unless a row has `width` fields; `place` is the location of the row in messages.
///
/// # Errors
/// If the record has another number of fields.
pub fn check_width(place: &str, record: &csv::StringRecord, width: usize) -> Result<()> {
    if record.len() == width {
        return Ok(());
    }
    let given = format!("{} columns", record.len());
    let allowed = format!("{width} columns in every row");
    Err(Error::input(place, given, allowed))
}

/// Returns the field of a row as a finite number, or an error; `allowed` describes valid values.
///
/// # Errors
/// If the field is not a finite number.
pub fn finite(place: &str, column: &str, field: &str, allowed: &str) -> Result<f64> {
    let refused = || {
        Error::input(
            format!("{place}, column {column}"),
            // A field in quotes may contain line breaks.
            format!("`{field}`").replace('\n', " "),
            allowed,
        )
    };
    finite_number(field).ok_or_else(refused)
}

/// Table of numbers with named columns.
#[derive(Debug, Default)]
pub struct NumberTable {
    /// Name of the file, for error messages.
    pub place: String,
    header_line: u64,
    /// Names of the columns.
    pub names: Vec<String>,
    /// Values of each column, shape (n_rows,), in the order of `names`.
    pub columns: Vec<Vec<f64>>,
    /// Line number of each row in the file.
    pub lines: Vec<u64>,
}

impl NumberTable {
    /// Reads a whole table of numbers. Errors begin with `place`, the name of the file, and state line and column; `allowed` describes a valid file.
    ///
    /// # Errors
    /// If the file is not a table of finite numbers.
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

    /// Returns an error about the header of the table.
    pub fn refuse_header(&self, given: impl ToString, allowed: impl ToString) -> Error {
        let place = format!("{}, line {}", self.place, self.header_line);
        Error::input(place, given, allowed)
    }

    /// Returns the index of the column with this name.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known == name)
    }
}
