//! Input files of a command, which no command may overwrite.
//!
//! The functions [`open`], [`read`] and [`read_to_string`] record input files after [`protect_inputs`] has been called.
//! A `WholeFile` does not replace a recorded file under any path.

use crate::error::{Error, Result};
use std::collections::BTreeMap;
use std::fs::{self, File, Metadata};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Identity of a file on its device, independent of its path.
#[cfg(unix)]
type FileId = (u64, u64);
#[cfg(not(unix))]
type FileId = PathBuf;

/// Input files recorded so far, each with the path under which it was read; `None` if recording is off.
static INPUTS: Mutex<Option<BTreeMap<FileId, PathBuf>>> = Mutex::new(None);

/// Starts recording the files that this process reads, and prevents overwriting them. Inputs of an earlier command of the process are forgotten.
///
/// Call this function first in a command. A library does not call this function, because a program may read a file and replace it on purpose.
pub fn protect_inputs() {
    let mut inputs = INPUTS.lock().unwrap_or_else(|e| e.into_inner());
    *inputs = Some(BTreeMap::new());
}

/// Opens a file for reading and records the file as an input.
///
/// # Errors
/// If the file cannot be opened.
pub fn open(path: &Path) -> io::Result<File> {
    let file = File::open(path)?;
    let mut inputs = INPUTS.lock().unwrap_or_else(|e| e.into_inner());
    if let Some(inputs) = &mut *inputs
        && let Some(id) = file.metadata().ok().and_then(|meta| file_id(path, &meta))
    {
        inputs.entry(id).or_insert_with(|| path.to_owned());
    }
    Ok(file)
}

/// Reads a whole file and records it as an input.
///
/// # Errors
/// If the file cannot be read.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads a whole text file and records it as an input.
///
/// # Errors
/// If the file cannot be read or is not UTF-8.
pub fn read_to_string(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    open(path)?.read_to_string(&mut text)?;
    Ok(text)
}

/// Returns an error if a file is a Git LFS pointer instead of the content. `place` is the name of the file, and `bytes` its beginning.
///
/// # Errors
/// If the bytes are a pointer of Git LFS.
pub fn check_content(place: impl std::fmt::Display, bytes: &[u8]) -> Result<()> {
    match bytes.starts_with(b"version https://git-lfs") {
        true => {
            let given = "a pointer of Git LFS without the content of the file";
            Err(Error::input(place, given, "the file itself (git lfs pull)"))
        }
        false => Ok(()),
    }
}

/// Returns an error if writing the file at `path` would destroy an input of this process.
///
/// # Errors
/// If this process has read the file, also through a link or another path.
pub fn check_output(path: &Path) -> Result<()> {
    let Some(id) = fs::metadata(path)
        .ok()
        .and_then(|meta| file_id(path, &meta))
    else {
        return Ok(());
    };
    let inputs = INPUTS.lock().unwrap_or_else(|e| e.into_inner());
    let Some(read_as) = inputs.as_ref().and_then(|inputs| inputs.get(&id)) else {
        return Ok(());
    };
    let given = match read_as == path {
        true => "is read by this command".to_owned(),
        false => format!(
            "is the file {}, which this command reads",
            read_as.display()
        ),
    };
    let allowed = "an output that is no input; nothing was written";
    Err(Error::input(path.display(), given, allowed))
}

/// Returns a recorded input file in a folder or its subfolders; `None` if there is none.
pub fn input_within(folder: &Path) -> Option<PathBuf> {
    let folder = folder.canonicalize().ok()?;
    let inputs = INPUTS.lock().unwrap_or_else(|e| e.into_inner());
    let mut paths = inputs.iter().flat_map(BTreeMap::values);
    let is_within = |path: &&PathBuf| {
        path.canonicalize()
            .is_ok_and(|path| path.starts_with(&folder))
    };
    paths.find(is_within).cloned()
}

/// Returns the identity of a file; `None` for a pipe or a device, because writing does not replace them.
#[cfg(unix)]
fn file_id(_: &Path, meta: &Metadata) -> Option<FileId> {
    use std::os::unix::fs::MetadataExt;
    meta.is_file().then(|| (meta.dev(), meta.ino()))
}

#[cfg(not(unix))]
fn file_id(path: &Path, meta: &Metadata) -> Option<FileId> {
    meta.is_file().then(|| path.canonicalize().ok()).flatten()
}
