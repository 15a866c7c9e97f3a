//! Exclusive lock of a journal file.

use crate::error::{Error, Result};
use std::fs::{File, TryLockError};
use std::ops::{Deref, DerefMut};
use std::path::Path;

/// File that is locked against other runs until this value is dropped.
///
/// A child process that another thread is starting has a copy of each open file until its own program begins. Closing the file would not end the lock in this
/// time, so the lock is released explicitly.
#[derive(Debug)]
pub(crate) struct LockedFile(File);

impl LockedFile {
    /// Locks an open file. `path` is its path for error sentences.
    ///
    /// # Errors
    /// If another run has locked the file, or the file system cannot lock files.
    pub(crate) fn new(path: &Path, file: File) -> Result<Self> {
        match file.try_lock() {
            Ok(()) => Ok(Self(file)),
            Err(TryLockError::WouldBlock) => Err(Error::input(
                path.display(),
                "another run is writing to it",
                "one run in a folder at a time: wait for that one, or name another folder with --out",
            )),
            Err(TryLockError::Error(error)) => Err(Error::io(path, "lock", error)),
        }
    }
}

impl Deref for LockedFile {
    type Target = File;

    fn deref(&self) -> &File {
        &self.0
    }
}

impl DerefMut for LockedFile {
    fn deref_mut(&mut self) -> &mut File {
        &mut self.0
    }
}

impl Drop for LockedFile {
    fn drop(&mut self) {
        // If this fails, the lock ends when the last copy of the file is closed.
        let _ = self.0.unlock();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lock_ends_while_a_copy_of_the_file_is_open() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        let file = File::create(&path).unwrap();
        // A child process has such a copy before its program begins.
        let copy = file.try_clone().unwrap();
        let locked = LockedFile::new(&path, file).unwrap();
        let open = || File::open(&path).unwrap();
        let error = LockedFile::new(&path, open()).unwrap_err().to_string();
        assert!(error.contains("another run is writing to it"), "{error}");
        drop(locked);
        LockedFile::new(&path, open()).unwrap();
        drop(copy);
    }
}
