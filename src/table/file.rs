//! A file of rows, before there are any.

use super::{Columns, Table};
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
    /// Those of [`Table::of`].
    pub fn of(&self, rows: &[R]) -> Result<Table>
    where
        R: Serialize,
    {
        Ok(self.described(Table::of(self.name, self.title, rows)?))
    }

    /// The table that stands in a folder.
    ///
    /// # Errors
    /// Those of [`Table::read`].
    pub fn read(&self, folder: &Path) -> Result<Table> {
        let table = Table::read::<R>(self.name, self.title, folder)?;
        Ok(self.described(table))
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
