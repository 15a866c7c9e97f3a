//! Journals of a study's shards in a result folder, and their union.

use crate::engine::journal::identity::Identity;
use crate::engine::journal::journal_file::Journal;
use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

impl Journal {
    /// Adds the records of all shard journals in the given folders, and returns the number of these journals.
    ///
    /// # Errors
    /// If a folder or a journal cannot be read, or a journal belongs to another study.
    pub fn take_from_shards<'a>(
        &mut self,
        identity: &Identity,
        folders: impl IntoIterator<Item = &'a Path>,
    ) -> Result<usize> {
        let mut n_journals = 0;
        for folder in folders {
            for path in shard_journals(folder)? {
                n_journals += 1;
                if let Some((begun, shard)) = Self::read(&path)? {
                    let place = path.display().to_string();
                    identity.check_same((&begun, shard.records()), &place)?;
                    self.take_from(shard)?;
                }
            }
        }
        Ok(n_journals)
    }
}

/// Returns the shard journals in a folder, sorted by name.
fn shard_journals(folder: &Path) -> Result<Vec<PathBuf>> {
    let failed = |e| Error::io(folder, "read", e);
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        // The file name has the form of `Shard::file_name`.
        if name.starts_with("journal.") && name.contains("-of-") && name.ends_with(".jsonl") {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}
