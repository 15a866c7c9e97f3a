//! CSV files that are written row by row.

use super::whole_file::WholeFile;
use crate::error::Result;
use serde::Serialize;
use std::io::{self, Write};
use std::path::Path;

/// CSV file that is written row by row in bounded memory. The header consists of the field names of the first row.
#[derive(Debug)]
pub struct CsvFile {
    file: WholeFile,
    has_header: bool,
}

impl CsvFile {
    /// Starts a CSV file; `commit` moves it to `path` when it is complete.
    ///
    /// # Errors
    /// If the file cannot be created.
    pub fn create(path: &Path) -> Result<Self> {
        Ok(Self {
            file: WholeFile::create(path)?,
            has_header: false,
        })
    }

    /// Appends a row to the table; `row` is a struct with one field per column.
    ///
    /// # Errors
    /// If the row cannot be written.
    pub fn row(&mut self, row: impl Serialize) -> Result<()> {
        let is_first = !std::mem::replace(&mut self.has_header, true);
        // Each row uses a separate buffer, because flushing the CSV writer would flush the file with every row.
        let mut csv = csv::WriterBuilder::new()
            .has_headers(is_first)
            .from_writer(Vec::new());
        self.file.write(|writer| {
            csv.serialize(row).map_err(io::Error::other)?;
            writer.write_all(&csv.into_inner().map_err(|e| e.into_error())?)
        })
    }

    /// Flushes the CSV file to disk and moves it to its path.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn commit(self) -> Result<()> {
        self.file.commit()
    }
}
