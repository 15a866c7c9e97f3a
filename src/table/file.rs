//! A file of rows, before there are any.

use super::{Column, Columns, Table};
use crate::error::{Error, Result};
use serde::Serialize;
use std::marker::PhantomData;
use std::path::Path;

/// What is known of a table but for its rows.
pub struct File<R> {
    name: &'static str,
    title: &'static str,
    note: &'static str,
    repeats: bool,
    is_summary: bool,
    rows: PhantomData<fn(R)>,
}

impl<R: Columns> File<R> {
    /// Its name, what it holds, and how to read it: a table without times of rows of work items.
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

    /// Its name.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// The same, of times: no two runs give the same bytes.
    pub const fn of_times(mut self) -> Self {
        self.repeats = false;
        self
    }

    /// The same, made of the rows of all work items.
    pub const fn summary(mut self) -> Self {
        self.is_summary = true;
        self
    }

    /// The table of some rows. Numbers are written in the shortest form that reads back as the same bits.
    ///
    /// # Errors
    /// Rows that have no such form; the error names the file.
    pub fn of(&self, rows: &[R]) -> Result<Table>
    where
        R: Serialize,
    {
        self.of_columns(R::columns(), rows)
    }

    /// The same of rows that have other columns than their type says: those of axes that a study names itself.
    ///
    /// # Errors
    /// Those of [`of`](Self::of); a row with other columns.
    pub fn of_columns(&self, columns: Vec<Column>, rows: &[impl Serialize]) -> Result<Table> {
        let csv = csv_of(rows, &columns);
        let csv = csv.map_err(|e| Error::io(self.name, "write", std::io::Error::other(e)))?;
        self.table(columns, Path::new(self.name), csv)
    }

    /// The table that stands in a folder.
    ///
    /// # Errors
    /// A file that cannot be read, or has other columns or values; the error names file, line and column.
    pub fn read(&self, folder: &Path) -> Result<Table> {
        self.read_columns(R::columns(), folder)
    }

    /// The same of a file that has these columns.
    ///
    /// # Errors
    /// Those of [`read`](Self::read).
    pub fn read_columns(&self, columns: Vec<Column>, folder: &Path) -> Result<Table> {
        let path = folder.join(self.name);
        let csv = crate::files::read(&path)
            .map_err(|e| Error::unreadable(&path, "a table that bubbletouch run wrote", e))?;
        self.table(columns, &path, csv)
    }

    /// The same where there is such a file: of a part that a study may leave out.
    ///
    /// # Errors
    /// Those of [`read`](Self::read).
    pub fn read_if_there(&self, folder: &Path) -> Result<Option<Table>> {
        let is_there = folder.join(self.name).exists();
        is_there.then(|| self.read(folder)).transpose()
    }

    fn table(&self, columns: Vec<Column>, path: &Path, csv: Vec<u8>) -> Result<Table> {
        let read = Table::from_csv((self.name, self.title), columns, path, csv)?;
        Ok(Table {
            note: self.note.to_owned(),
            repeats: self.repeats,
            is_summary: self.is_summary,
            ..read
        })
    }
}

/// A table of no rows has the header of those columns that every study has.
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
