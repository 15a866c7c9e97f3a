//! CSV files that grow row by row.

use super::whole_file::WholeFile;
use crate::error::{Error, Result};
use serde::Serialize;
use std::io::{self, Write};
use std::path::Path;

/// A CSV file that grows row by row, in bounded memory; the header is that of the first row's fields.
#[derive(Debug)]
pub struct CsvFile {
    file: WholeFile,
    has_header: bool,
}

impl CsvFile {
    /// Starts a table that will stand at `path`.
    ///
    /// # Errors
    /// There can be no file.
    pub fn create(path: &Path) -> Result<Self> {
        Ok(Self {
            file: WholeFile::create(path)?,
            has_header: false,
        })
    }

    /// Adds a row: a struct with one field a column.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn row(&mut self, row: impl Serialize) -> Result<()> {
        let is_first = !std::mem::replace(&mut self.has_header, true);
        // Through a buffer of its own: flushing the CSV writer would flush the file with every row.
        let mut csv = csv::WriterBuilder::new()
            .has_headers(is_first)
            .from_writer(Vec::new());
        self.file.write(|writer| {
            csv.serialize(row).map_err(io::Error::other)?;
            writer.write_all(&csv.into_inner().map_err(|e| e.into_error())?)
        })
    }

    /// Makes it durable and puts it in place.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn commit(self) -> Result<()> {
        self.file.commit()
    }
}

/// What to say of a table that cannot be read: the file, the line where it is known, and what is `allowed`.
pub fn table_error(path: &Path, allowed: &str) -> impl Fn(csv::Error) -> Error {
    move |error| {
        let line = error.position().map(|at| format!(", line {}", at.line()));
        let place = format!("{}{}", path.display(), line.unwrap_or_default());
        Error::input(place, format!("cannot be read ({error})"), allowed)
    }
}
