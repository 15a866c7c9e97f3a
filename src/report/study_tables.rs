//! The tables of a study as files, and which of them come out again.

use crate::error::Result;
use crate::report::csv_tables::{TableHashes, csv_content};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;

/// Names and contents of tables, in the order of writing.
pub type TableFiles = Vec<(&'static str, Vec<u8>)>;

/// All result tables of a study that is made of [pieces](crate::study::pieces).
pub trait StudyTables {
    /// Files without times whose rows are those of pieces: a piece that runs again gives the same rows.
    const OF_PIECES: &'static [&'static str];
    /// Files without times that are made of the rows of all pieces.
    const OF_ALL: &'static [&'static str];

    /// Every table as CSV.
    ///
    /// # Errors
    /// A table that has no such form.
    fn files(&self) -> Result<TableFiles>;

    /// SHA-256 of every table.
    ///
    /// # Errors
    /// As of [`files`](Self::files).
    fn hashes(&self) -> Result<TableHashes> {
        let is_repeatable =
            |name: &str| Self::OF_PIECES.contains(&name) || Self::OF_ALL.contains(&name);
        Ok(TableHashes::of(self.files()?, is_repeatable))
    }
}

/// One of them.
pub(super) fn table_file(
    name: &'static str,
    rows: &[impl Serialize + DeserializeOwned],
) -> Result<(&'static str, Vec<u8>)> {
    Ok((name, csv_content(Path::new(name), rows)?))
}
