//! Old results, kept beside the new.

use super::journal_file::{JOURNAL_FILE, lock};
use crate::error::{Error, Result};
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// Renames a folder of results to the first free of `NAME.1`, `NAME.2` …; its new name, or `None` where there is none.
///
/// # Errors
/// A run is still writing to it; it cannot be renamed.
pub fn set_aside(folder: &Path) -> Result<Option<PathBuf>> {
    if !folder.exists() {
        return Ok(None);
    }
    if !folder.is_dir() {
        let allowed = "a folder, or a path where one can be made";
        return Err(Error::input(folder.display(), "a file", allowed));
    }
    let journal = folder.join(JOURNAL_FILE);
    let held = File::open(&journal);
    if let Ok(file) = &held {
        lock(&journal, file)?;
    }
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    let free = (1..)
        .map(|k| folder.with_file_name(format!("{name}.{k}")))
        .find(|path| !path.exists());
    let free = free.expect("there is no last number");
    fs::rename(folder, &free).map_err(|e| Error::io(folder, "rename", e))?;
    Ok(Some(free))
}
