//! Specification of a table file, independent of the rows in it.

use super::{Column, Columns, Table};
use crate::error::{Error, Result};
use crate::files::has_table;
use serde::Serialize;
use std::marker::PhantomData;
use std::path::Path;

/// Specification of a table's CSV file: name, title, note and type of the rows.
pub struct File<R> {
    name: &'static str,
    title: &'static str,
    note: &'static str,
    repeats: bool,
    is_summary: bool,
    rows: PhantomData<fn(R)>,
}

/// Description of a table file, for the reference page of all tables.
pub struct FileAbout {
    /// Name of the CSV file.
    pub name: &'static str,
    /// Title of the table.
    pub title: &'static str,
    /// Note that explains the table; may be empty.
    pub note: &'static str,
    /// Whether a repeated run writes identical bytes.
    pub repeats: bool,
    /// Columns of the table, including the optional ones.
    pub columns: Vec<Column>,
}

impl<R: Columns> File<R> {
    /// Creates the specification of a table from its file name, title and note. By default, the table is reproducible and not a summary.
    pub const fn new(name: &'static str, title: &'static str, note: &'static str) -> Self {
        Self {
            name,
            title,
            note,
            repeats: true,
            is_summary: false,
            rows: PhantomData,
        }
    }

    /// Returns the name of the CSV file that contains the table.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// Describes the file.
    pub fn about(&self) -> FileAbout {
        FileAbout {
            name: self.name,
            title: self.title,
            note: self.note,
            repeats: self.repeats,
            columns: R::columns(),
        }
    }

    /// Marks the table as a table of computing times, which differ between runs.
    pub const fn of_times(mut self) -> Self {
        self.repeats = false;
        self
    }

    /// Marks the table as a summary, which is computed from the rows of all work items.
    pub const fn summary(mut self) -> Self {
        self.is_summary = true;
        self
    }

    /// Creates a table from the given rows. Numbers are written in the shortest form that reads back as the same bits.
    ///
    /// # Errors
    /// If a row cannot be serialised as CSV; the error names the file.
    pub fn table(&self, rows: &[R]) -> Result<Table>
    where
        R: Serialize,
    {
        self.of_columns(R::columns(), rows)
    }

    /// Creates a table from rows with the given columns; used by studies that define additional axes.
    ///
    /// # Errors
    /// If a row cannot be serialised as CSV, or has other columns.
    pub fn of_columns(&self, columns: Vec<Column>, rows: &[impl Serialize]) -> Result<Table> {
        let csv = csv_of(rows, &columns);
        let csv = csv.map_err(|e| Error::io(self.name, "write", std::io::Error::other(e)))?;
        self.parse(columns, Path::new(self.name), csv)
    }

    /// Reads the table from its CSV file in a folder.
    ///
    /// # Errors
    /// If the file cannot be read, or has other columns or invalid values; the error names file, line and column.
    pub fn read(&self, folder: &Path) -> Result<Table> {
        self.read_columns(R::columns(), folder)
    }

    /// Reads the table from its CSV file in a folder, with the given columns instead of the columns of the row type.
    ///
    /// # Errors
    /// If the file cannot be read, or has other columns or invalid values.
    pub fn read_columns(&self, columns: Vec<Column>, folder: &Path) -> Result<Table> {
        let path = folder.join(self.name);
        let csv = crate::files::read(&path)
            .map_err(|e| Error::unreadable(&path, "a table that bubbletouch run wrote", e))?;
        self.parse(columns, &path, csv)
    }

    /// Reads an optional table of a study from its CSV file in a folder. Returns `None` if the file does not exist or is no table of the folder's last run.
    ///
    /// # Errors
    /// If the file cannot be read, or has other columns or invalid values.
    pub fn read_if_there(&self, folder: &Path) -> Result<Option<Table>> {
        let is_there = has_table(folder, self.name);
        is_there.then(|| self.read(folder)).transpose()
    }

    /// Creates the table of the content of its CSV file; `path` is only used in errors.
    ///
    /// # Errors
    /// If the file has other columns or invalid values.
    pub fn parse(&self, columns: Vec<Column>, path: &Path, csv: Vec<u8>) -> Result<Table> {
        let read = Table::from_csv((self.name, self.title), columns, path, csv)?;
        Ok(Table {
            note: self.note.to_owned(),
            repeats: self.repeats,
            is_summary: self.is_summary,
            ..read
        })
    }
}

/// Returns the rows as the bytes of a CSV file. Without rows, the file has only a header, with the columns that are not optional.
fn csv_of<R: Serialize>(
    rows: &[R],
    columns: &[Column],
) -> std::result::Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    if rows.is_empty() {
        let always = columns.iter().filter(|column| !column.is_optional);
        writer.write_record(always.map(|column| column.name.as_bytes()))?;
    }
    for row in rows {
        writer.serialize(row)?;
    }
    let bytes = writer.into_inner().map_err(|e| e.into_error());
    bytes.map_err(csv::Error::from)
}
