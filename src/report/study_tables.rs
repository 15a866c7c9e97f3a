//! The tables of a study as files, and which of them come out again.

use crate::error::Result;
use crate::report::csv_tables::csv_content;
use crate::study::ContentHash;
use serde::Serialize;
use std::collections::BTreeMap;
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

    /// SHA-256 of every table without times, by its file's name: the same for the same study.
    ///
    /// # Errors
    /// As of [`files`](Self::files).
    fn repeatable_hashes(&self) -> Result<BTreeMap<String, String>> {
        let is_repeatable =
            |name: &&'static str| Self::OF_PIECES.contains(name) || Self::OF_ALL.contains(name);
        let files = self.files()?.into_iter();
        let files = files.filter(|(name, _)| is_repeatable(name));
        let hash = |content: Vec<u8>| ContentHash::default().bytes(content).hex();
        Ok(files
            .map(|(name, content)| (name.to_owned(), hash(content)))
            .collect())
    }
}

/// One of them.
pub(super) fn table_file(
    name: &'static str,
    rows: &[impl Serialize],
) -> Result<(&'static str, Vec<u8>)> {
    Ok((name, csv_content(Path::new(name), rows)?))
}
