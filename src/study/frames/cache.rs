//! Touches that took long to make, kept in a folder by what they were made from.

use super::frame_file::{FrameFile, FrameFileWriter};
use super::{FrameFacts, Frames};
use crate::error::{Error, Result};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The ending of its files.
const ENDING: &str = "touches";

/// A folder of touches with a limit: what was used longest ago goes first.
#[derive(Clone, Debug)]
pub struct TouchCache {
    folder: PathBuf,
    limit: u64,
}

/// Touches in a cache.
#[derive(Clone, Debug, PartialEq)]
pub struct CachedTouches {
    /// The file.
    pub path: PathBuf,
    /// Its bytes.
    pub n_bytes: u64,
    /// When it was written or last read.
    pub used: SystemTime,
}

impl CachedTouches {
    /// What it says that it holds; its frames are not read.
    ///
    /// # Errors
    /// The file cannot be read, or is damaged around its frames.
    pub fn facts(&self) -> Result<FrameFacts> {
        FrameFile::facts_of(&self.path)
    }

    /// What it holds, every byte checked.
    ///
    /// # Errors
    /// The file cannot be read, or is damaged.
    pub fn checked_facts(&self) -> Result<FrameFacts> {
        FrameFile::checked_facts_of(&self.path)
    }
}

impl TouchCache {
    /// Of a folder, which is made when something is kept, and of so many bytes at most.
    pub fn new(folder: impl Into<PathBuf>, limit: u64) -> Self {
        Self {
            folder: folder.into(),
            limit,
        }
    }

    /// The file of a key.
    pub(super) fn path(&self, key: &str) -> PathBuf {
        self.folder.join(format!("{key}.{ENDING}"))
    }

    /// Makes the folder.
    pub(super) fn prepare(&self) -> Result<()> {
        fs::create_dir_all(&self.folder).map_err(|e| Error::io(&self.folder, "create folder", e))
    }

    /// What is kept under a key, if it is whole; it counts as used now.
    pub(super) fn open(&self, key: &str) -> Result<Option<FrameFile>> {
        let path = self.path(key);
        let Some(file) = FrameFile::open(&path)? else {
            return Ok(None);
        };
        // A folder that others own can be read all the same; its order of use then stays as it is.
        let _ = File::options()
            .append(true)
            .open(&path)
            .and_then(|file| file.set_modified(SystemTime::now()));
        Ok(Some(file))
    }

    /// Keeps frames that are in memory, if they are within the limit, and makes room for them.
    pub(super) fn keep(&self, key: &str, frames: &Frames) -> Result<()> {
        let Some(bytes) = frames.kept.in_memory() else {
            return Ok(());
        };
        let n_bytes: usize = bytes.iter().map(|frame| frame.len() + 8).sum();
        if n_bytes as u64 > self.limit {
            return Ok(());
        }
        self.prepare()?;
        let mut file = FrameFileWriter::create(&self.path(key))?;
        for frame in bytes {
            file.put(frame)?;
        }
        file.commit(&frames.facts)?;
        self.make_room()
    }

    /// Whether a file is within the limit.
    pub(super) fn may_keep(&self, path: &Path) -> bool {
        fs::metadata(path).is_ok_and(|meta| meta.len() <= self.limit)
    }

    /// Keeps within the limit.
    pub(super) fn make_room(&self) -> Result<()> {
        self.prune(self.limit).map(|_| ())
    }

    /// All that is kept, what was used last first.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn list(&self) -> Result<Vec<CachedTouches>> {
        let read = |error| Error::io(&self.folder, "read", error);
        let entries = match fs::read_dir(&self.folder) {
            Ok(entries) => entries,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error) => {
                let allowed = "a folder beside whose results touches are kept";
                return Err(Error::unreadable(&self.folder, allowed, error));
            }
        };
        let mut all = Vec::new();
        for entry in entries {
            let path = entry.map_err(read)?.path();
            if path.extension().is_none_or(|ending| ending != ENDING) {
                continue;
            }
            // Another process may have pruned it since.
            let Ok(meta) = fs::metadata(&path) else {
                continue;
            };
            all.push(CachedTouches {
                n_bytes: meta.len(),
                used: meta.modified().map_err(read)?,
                path,
            });
        }
        all.sort_by(|a, b| b.used.cmp(&a.used).then_with(|| a.path.cmp(&b.path)));
        Ok(all)
    }

    /// Removes what was used longest ago until at most so many bytes are left; what went.
    ///
    /// # Errors
    /// A file cannot be removed.
    pub fn prune(&self, most: u64) -> Result<Vec<CachedTouches>> {
        let mut sum = 0;
        let mut gone = Vec::new();
        for touches in self.list()? {
            sum += touches.n_bytes;
            if sum <= most {
                continue;
            }
            match fs::remove_file(&touches.path) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                    return Err(Error::io(&touches.path, "remove", error));
                }
                _ => gone.push(touches),
            }
        }
        Ok(gone)
    }
}
