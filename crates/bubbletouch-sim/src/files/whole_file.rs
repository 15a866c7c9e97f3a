//! Files that are either complete or absent: they are written under a temporary name, then renamed.

use super::inputs::check_output;
use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Number of files that this process has started. The number makes temporary names unique if two threads write to one path.
static N_STARTED: AtomicU64 = AtomicU64::new(0);

/// File that is being written. `commit` moves the temporary file to its path; if the value is dropped earlier, the temporary file is removed.
#[derive(Debug)]
pub struct WholeFile {
    /// Path of the file as given, for error messages.
    given: PathBuf,
    path: PathBuf,
    /// Path of the temporary file; `None` for a device or a pipe, which cannot be replaced by renaming.
    partial: Option<PathBuf>,
    writer: BufWriter<File>,
}

impl WholeFile {
    /// Starts a file; `commit` moves it to `path` when it is complete. If `path` is a symbolic link, the file replaces the target of the link.
    ///
    /// # Errors
    /// If this process has read the file (`protect_inputs`), or if the file cannot be created.
    pub fn create(path: &Path) -> Result<Self> {
        check_output(path)?;
        let given = path;
        let path = &link_target(path)?;
        let name = path.file_name().ok_or_else(|| {
            Error::input(path.display(), "no file name", "a path that ends in one")
        })?;
        let partial = match fs::metadata(path) {
            Ok(meta) if meta.is_dir() => {
                return Err(Error::input(path.display(), "a folder", "a file to write"));
            }
            Ok(meta) if !meta.is_file() => None,
            _ => {
                let mut partial = name.to_owned();
                let number = N_STARTED.fetch_add(1, Ordering::Relaxed);
                partial.push(format!(".{}.{number}.partial", std::process::id()));
                Some(path.with_file_name(partial))
            }
        };
        let target = partial.as_deref().unwrap_or(path);
        let file = File::create(target).map_err(|e| match e.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => {
                let folder = path.parent().unwrap_or(Path::new(""));
                let given = format!("there is no folder {}", folder.display());
                Error::input(
                    path.display(),
                    given,
                    "a file to write in a folder that is there",
                )
            }
            _ => Error::io(given, "write", e),
        })?;
        Ok(Self {
            given: given.to_owned(),
            path: path.to_owned(),
            partial,
            writer: BufWriter::new(file),
        })
    }

    /// Writes a part of the file with the function `fill`.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(
        &mut self,
        fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<()> {
        fill(&mut self.writer).map_err(|e| Error::io(&self.given, "write", e))
    }

    /// Flushes the file to disk and moves it to its path, replacing an existing file.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn commit(mut self) -> Result<()> {
        let Some(partial) = self.partial.clone() else {
            return self.write(|writer| writer.flush());
        };
        check_output(&self.path)?;
        self.write(|writer| {
            writer.flush()?;
            writer.get_ref().sync_all()
        })?;
        fs::rename(&partial, &self.path).map_err(|e| Error::io(&self.path, "rename", e))?;
        self.partial = None;
        Ok(())
    }
}

/// Maximum length of a chain of symbolic links, as in Linux. If larger, loops are detected later; if smaller, long chains fail.
const MAX_LINKS: usize = 40;

/// Returns the target of a symbolic link, or `path` itself if it is not a link.
///
/// # Errors
/// If the links form a loop.
fn link_target(path: &Path) -> Result<PathBuf> {
    let mut target = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&target) {
            Ok(next) => target = target.parent().unwrap_or(Path::new("")).join(next),
            // The path is not a link, or does not exist.
            Err(_) => return Ok(target),
        }
    }
    let allowed = "a link that leads to a file";
    let given = "links without an end";
    Err(Error::input(path.display(), given, allowed))
}

impl Drop for WholeFile {
    fn drop(&mut self) {
        if let Some(partial) = &self.partial {
            // The temporary file belongs to this process; a failure to remove it does not affect the result.
            let _ = fs::remove_file(partial);
        }
    }
}

/// Writes a file with the function `fill`. If writing fails, an existing file at `path` stays unchanged.
///
/// # Errors
/// If the file cannot be written, or if `fill` returns an error.
pub fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<()> {
    let mut file = WholeFile::create(path)?;
    file.write(fill)?;
    file.commit()
}

/// Writes bytes to the file at `path`. If writing fails, an existing file stays unchanged.
///
/// # Errors
/// If the file cannot be written.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<()> {
    write_whole(path, |writer| writer.write_all(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_that_fails_half_way_leaves_the_old_one_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        write_bytes(&path, b"old").unwrap();
        let failed = write_whole(&path, |writer| {
            writer.write_all(b"half of the new")?;
            Err(io::Error::other("the disk is gone"))
        });
        assert_eq!(failed.unwrap_err().exit_code(), 1);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["table.csv"]);
        write_bytes(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["table.csv"]);
    }

    #[test]
    fn a_folder_is_not_a_file() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(write_bytes(folder.path(), b"").unwrap_err().exit_code(), 2);
    }

    #[test]
    fn a_full_device_is_an_error_and_stays_a_device() {
        let full = Path::new("/dev/full");
        if !full.exists() {
            writeln!(std::io::stderr(), "SKIPPED: this system has no /dev/full")
                .expect("standard error takes a line");
            return;
        }
        let error = write_bytes(full, &[0; 100_000]).unwrap_err();
        assert_eq!(error.exit_code(), 1);
        assert!(!fs::metadata(full).unwrap().is_file());
    }
}
