//! Files of a result folder. All contents are computed before the first file is written.

use crate::error::{Error, Result};
use crate::files::write_bytes;
use crate::table::Table;
use std::fs;
use std::path::{Path, PathBuf};

/// Name and content of a file that is written to a folder.
pub type NamedFile = (String, Vec<u8>);

/// Returns the name and content of one CSV file for each table.
pub fn table_files(tables: &[Table]) -> Vec<NamedFile> {
    // A table that is derived from others has no file.
    let files = tables.iter().filter(|table| !table.csv.is_empty());
    let files = files.map(|table| (table.file.to_owned(), table.csv.clone()));
    files.collect()
}

/// Creates a folder if it is missing and writes all files in order. Each file is written completely or not at all. Returns the paths of the files.
///
/// # Errors
/// If the folder's path is a file, or a file cannot be written.
pub fn write_files(folder: &Path, files: Vec<NamedFile>) -> Result<Vec<PathBuf>> {
    if fs::metadata(folder).is_ok_and(|meta| !meta.is_dir()) {
        let allowed = "a folder, or a name that is free";
        return Err(Error::input(folder.display(), "is not a folder", allowed));
    }
    fs::create_dir_all(folder).map_err(|e| Error::io(folder, "create folder", e))?;
    let written = files.into_iter().map(|(name, content)| {
        let path = folder.join(name);
        write_bytes(&path, &content)?;
        Ok(path)
    });
    written.collect()
}
