//! The tables of a study as files, and which of them come out again.

use crate::error::Result;
use crate::kinds::recognition::Outcome;
use crate::report::csv_tables::{LIMITS_FILE, TableHashes, VARIANCE_FILE};
use crate::report::recognition::tables_of;

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

impl StudyTables for Outcome {
    const OF_PIECES: &'static [&'static str] = &["accuracy.csv"];
    const OF_ALL: &'static [&'static str] = &[
        "summary.csv",
        "confusion.csv",
        "comparison.csv",
        "confused.csv",
        "published.csv",
        VARIANCE_FILE,
        LIMITS_FILE,
    ];

    fn files(&self) -> Result<TableFiles> {
        let tables = tables_of(&self.tables, &self.limits)?.into_iter();
        let files = tables.filter(|table| !table.csv.is_empty());
        Ok(files.map(|table| (table.file, table.csv)).collect())
    }
}
