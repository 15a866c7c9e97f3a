//! The files of a study's folder: all of them made before the first is written.

use crate::error::{Error, Result};
use crate::files::write_bytes;
use crate::report::drawing::Drawing;
use crate::table::Table;
use rayon::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};

/// Files that will stand in a folder, in the order of writing; nothing is there before [`Folder::write`].
pub struct Folder<'a> {
    path: &'a Path,
    /// By name.
    files: Vec<(String, Content)>,
}

enum Content {
    Bytes(Vec<u8>),
    /// A PNG that is still to be drawn.
    Png(Drawing),
}

impl<'a> Folder<'a> {
    /// No files yet, for the folder at `path`, which need not exist.
    pub(super) fn new(path: &'a Path) -> Self {
        let files = Vec::new();
        Self { path, files }
    }

    /// The tables of a study.
    pub fn of_tables(path: &'a Path, tables: &[Table]) -> Self {
        let mut folder = Self::new(path);
        // A table that is made of others has no file.
        for table in tables.iter().filter(|table| !table.csv.is_empty()) {
            folder.add(table.file, table.csv.clone());
        }
        folder
    }

    /// Adds the files of another one, behind those that are there.
    pub fn append(&mut self, other: Self) {
        self.files.extend(other.files);
    }

    /// The content of a file that needs no drawing, by its name.
    pub fn file(&self, name: &str) -> Option<&[u8]> {
        let (_, content) = self.files.iter().find(|(known, _)| known == name)?;
        match content {
            Content::Bytes(bytes) => Some(bytes),
            Content::Png(_) => None,
        }
    }

    /// Adds a file by its name in the folder.
    pub(super) fn add(&mut self, name: impl Into<String>, content: impl Into<Vec<u8>>) {
        let content = Content::Bytes(content.into());
        self.files.push((name.into(), content));
    }

    /// Adds a drawing as PNG; its pixels are made with all others, on all threads.
    pub(super) fn add_png(&mut self, name: impl Into<String>, drawing: &Drawing) {
        let content = Content::Png(drawing.clone());
        self.files.push((name.into(), content));
    }

    /// Adds a chart as PNG and as SVG; its name has no ending.
    pub(super) fn add_chart(&mut self, name: &str, title: &str, drawing: &Drawing) {
        self.add_png(format!("{name}.png"), drawing);
        self.add(format!("{name}.svg"), drawing.svg(title));
    }

    /// The same with every PNG drawn.
    ///
    /// # Errors
    /// A picture that cannot be drawn.
    pub(super) fn drawn(self) -> Result<Self> {
        let path = self.path;
        let files = self.into_files()?.into_iter();
        let files = files.map(|(name, bytes)| (name, Content::Bytes(bytes)));
        Ok(Self {
            path,
            files: files.collect(),
        })
    }

    /// Every file whole, name and content.
    fn into_files(self) -> Result<Vec<(String, Vec<u8>)>> {
        let whole = |(name, content)| match content {
            Content::Bytes(bytes) => Ok((name, bytes)),
            Content::Png(drawing) => Ok((name, drawing.png()?)),
        };
        self.files.into_par_iter().map(whole).collect()
    }

    /// Makes the folder if it is missing and writes every file whole; returns their paths.
    ///
    /// Everything is drawn before the first file is written.
    ///
    /// # Errors
    /// A picture that cannot be drawn; a file that is in the folder's way or cannot be written.
    pub fn write(self) -> Result<Vec<PathBuf>> {
        let path = self.path;
        let files = self.into_files()?;
        make_folder(path)?;
        let written = files.into_iter().map(|(name, content)| {
            let path = path.join(name);
            write_bytes(&path, &content)?;
            Ok(path)
        });
        written.collect()
    }
}

fn make_folder(path: &Path) -> Result<()> {
    if fs::metadata(path).is_ok_and(|meta| !meta.is_dir()) {
        return Err(Error::input(
            path.display(),
            "is not a folder",
            "a folder, or a name that is free",
        ));
    }
    fs::create_dir_all(path).map_err(|e| Error::io(path, "create folder", e))
}
