//! Renaming of old result folders, so that new results do not replace them.

use crate::engine::journal::journal_file::{JOURNAL_FILE, LockedFile, is_journal, names_in};
use crate::error::{Error, Result};
use crate::files::{MANIFEST_FILE, OwnedFiles, RUN, input_within};
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// Renames a result folder to the first free name of `NAME.1`, `NAME.2`, … Returns the new path, or `None` if there is no folder to rename. If `folder` is a
/// symbolic link, its target is renamed, and the link remains.
///
/// # Errors
/// If the folder contains files but no results, or a file that this command reads. If a run is still writing to it, or it cannot be renamed.
pub fn rename_old_results(folder: &Path) -> Result<Option<PathBuf>> {
    check_set_aside(folder)?;
    if !folder.exists() {
        return Ok(None);
    }
    let is_link = fs::symlink_metadata(folder).is_ok_and(|meta| meta.is_symlink());
    let folder = &match is_link || folder.file_name().is_none() {
        true => folder
            .canonicalize()
            .map_err(|e| Error::io(folder, "read", e))?,
        false => folder.to_owned(),
    };
    let journal = folder.join(JOURNAL_FILE);
    let _held = match File::open(&journal) {
        Ok(file) => Some(LockedFile::new(&journal, file)?),
        Err(_) => None,
    };
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    let free = (1..)
        .map(|k| folder.with_file_name(format!("{name}.{k}")))
        .find(|path| !path.exists());
    let free = free.expect("there is no last number");
    fs::rename(folder, &free).map_err(|e| Error::io(folder, "rename", e))?;
    if is_link {
        // The symbolic link then points to a new folder.
        fs::create_dir(folder).map_err(|e| Error::io(folder, "create folder", e))?;
    }
    Ok(Some(free))
}

/// Checks that a folder may be renamed: it is missing, empty or a result folder, and contains no file that the command reads.
///
/// # Errors
/// If the folder cannot be renamed.
pub fn check_set_aside(folder: &Path) -> Result<()> {
    if !folder.exists() {
        return Ok(());
    }
    if !folder.is_dir() {
        let allowed = "a folder, or a path where one can be made";
        return Err(Error::input(folder.display(), "a file", allowed));
    }
    let given = match input_within(folder) {
        Some(input) => Some(format!(
            "holds {}, which this command reads",
            input.display()
        )),
        None if is_foreign(folder)? => Some("is no folder of results".to_owned()),
        None => None,
    };
    given.map_or(Ok(()), |given| {
        let allowed = "a folder that bubbletouch run wrote; nothing was renamed";
        Err(Error::input(folder.display(), given, allowed))
    })
}

/// Returns whether a folder contains files, but neither a manifest nor a journal of this program.
fn is_foreign(folder: &Path) -> Result<bool> {
    let names = names_in(folder)?;
    if names.is_empty() {
        return Ok(false);
    }
    OwnedFiles::read(folder, RUN)?;
    let is_ours = |name: &String| name == MANIFEST_FILE || is_journal(name);
    Ok(!names.iter().any(is_ours))
}
