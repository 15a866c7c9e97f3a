//! The files of a study's folder: all of them made before the first is written.

use crate::error::{Error, Result};
use crate::files::write_bytes;
use crate::table::Table;
use std::fs;
use std::path::{Path, PathBuf};

/// Files that will stand in a folder, in the order of writing; nothing is there before [`Folder::write`].
pub struct Folder<'a> {
    path: &'a Path,
    /// Name and content of each.
    pub(super) files: Vec<(String, Vec<u8>)>,
}

impl<'a> Folder<'a> {
    /// The tables of a study, for the folder at `path`, which need not exist.
    pub fn of_tables(path: &'a Path, tables: &[Table]) -> Self {
        // A table that is made of others has no file.
        let files = tables.iter().filter(|table| !table.csv.is_empty());
        let files = files.map(|table| (table.file.to_owned(), table.csv.clone()));
        Self {
            path,
            files: files.collect(),
        }
    }

    /// Adds the files of another one, behind those that are there.
    pub fn append(&mut self, other: Self) {
        self.files.extend(other.files);
    }

    /// The content of a file by its name.
    pub fn file(&self, name: &str) -> Option<&[u8]> {
        let mut files = self.files.iter();
        files.find_map(|(known, content)| (known == name).then_some(&content[..]))
    }

    /// Makes the folder if it is missing and writes every file whole; returns their paths.
    ///
    /// # Errors
    /// A file that is in the folder's way or cannot be written.
    pub fn write(self) -> Result<Vec<PathBuf>> {
        if fs::metadata(self.path).is_ok_and(|meta| !meta.is_dir()) {
            let allowed = "a folder, or a name that is free";
            return Err(Error::input(
                self.path.display(),
                "is not a folder",
                allowed,
            ));
        }
        fs::create_dir_all(self.path).map_err(|e| Error::io(self.path, "create folder", e))?;
        let written = self.files.into_iter().map(|(name, content)| {
            let path = self.path.join(name);
            write_bytes(&path, &content)?;
            Ok(path)
        });
        written.collect()
    }
}
