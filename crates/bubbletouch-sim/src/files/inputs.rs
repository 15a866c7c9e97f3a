//! The files that a command reads: no command may write over one of them.
//!
//! Readers open files through [`open`], [`read`] and [`read_to_string`], which record them once [`protect_inputs`] was called.
//! [`WholeFile`](super::WholeFile) refuses to replace a recorded file, whatever path leads to it.

use crate::error::{Error, Result};
use std::collections::BTreeMap;
use std::fs::{self, File, Metadata};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Identity of a file, whatever path leads to it.
#[cfg(unix)]
type FileId = (u64, u64);
#[cfg(not(unix))]
type FileId = PathBuf;

/// Recorded files, with the path under which they were read. `None`: nothing is recorded.
static INPUTS: Mutex<Option<BTreeMap<FileId, PathBuf>>> = Mutex::new(None);

/// Records from now on which files this process reads, and refuses to write over them.
///
/// The command calls this first. A library does not: a program may read a file and replace it on purpose.
pub fn protect_inputs() {
    let mut inputs = INPUTS.lock().unwrap_or_else(|e| e.into_inner());
    inputs.get_or_insert_default();
}

/// Opens a file to read it, and records it as an input.
///
/// # Errors
/// Those of [`File::open`].
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

/// Reads a whole file, and records it as an input.
///
/// # Errors
/// Those of [`fs::read`].
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads a whole text, and records its file as an input.
///
/// # Errors
/// Those of [`fs::read_to_string`].
pub fn read_to_string(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    open(path)?.read_to_string(&mut text)?;
    Ok(text)
}

/// Checks that a file can be written without destroying an input.
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

/// Returns a recorded input that lies in a folder or below it, if there is one.
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

/// Returns `None` for a pipe or a device, which writing does not replace.
#[cfg(unix)]
fn file_id(_: &Path, meta: &Metadata) -> Option<FileId> {
    use std::os::unix::fs::MetadataExt;
    meta.is_file().then(|| (meta.dev(), meta.ino()))
}

#[cfg(not(unix))]
fn file_id(path: &Path, meta: &Metadata) -> Option<FileId> {
    meta.is_file().then(|| path.canonicalize().ok()).flatten()
}
