//! A file of rows, before there are any.

use super::{Column, Columns, Table};
use crate::error::Result;
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

    /// The table of some rows.
    ///
    /// # Errors
    /// Rows that have no form in a file; the error names it.
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
    pub fn of_columns(&self, columns: Vec<Column>, rows: &[R]) -> Result<Table>
    where
        R: Serialize,
    {
        let made = Table::of_columns((self.name, self.title), columns, rows)?;
        Ok(self.described(made))
    }

    /// The table that stands in a folder.
    ///
    /// # Errors
    /// Those of [`Table::read`].
    pub fn read(&self, folder: &Path) -> Result<Table> {
        self.read_columns(R::columns(), folder)
    }

    /// The same of a file that has these columns.
    ///
    /// # Errors
    /// Those of [`read`](Self::read).
    pub fn read_columns(&self, columns: Vec<Column>, folder: &Path) -> Result<Table> {
        let read = Table::read_columns((self.name, self.title), columns, folder)?;
        Ok(self.described(read))
    }

    /// The same where there is such a file: of a part that a study may leave out.
    ///
    /// # Errors
    /// Those of [`Table::read`].
    pub fn read_if_there(&self, folder: &Path) -> Result<Option<Table>> {
        let is_there = folder.join(self.name).exists();
        is_there.then(|| self.read(folder)).transpose()
    }

    fn described(&self, table: Table) -> Table {
        Table {
            note: self.note.to_owned(),
            repeats: self.repeats,
            is_summary: self.is_summary,
            ..table
        }
    }
}
