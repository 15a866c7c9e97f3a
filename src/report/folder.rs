//! The files of a study's folder: all of them made before the first is written.

use crate::error::{Error, Result};
use crate::files::write_bytes;
use crate::report::csv_tables::csv_content;
use crate::report::drawing::Drawing;
use crate::report::study_tables::TableFiles;
use serde::Serialize;
use std::fs;
use std::path::{Path, PathBuf};

/// Files that will stand in a folder, in the order of writing.
pub(super) struct Folder<'a> {
    path: &'a Path,
    /// Name and content.
    files: Vec<(String, Vec<u8>)>,
}

impl<'a> Folder<'a> {
    /// No files yet, for the folder at `path`, which need not exist.
    pub fn new(path: &'a Path) -> Self {
        let files = Vec::new();
        Self { path, files }
    }

    /// Adds a file by its name in the folder.
    pub fn add(&mut self, name: impl Into<String>, content: impl Into<Vec<u8>>) {
        self.files.push((name.into(), content.into()));
    }

    /// Adds a table as CSV; the error names the file.
    pub fn add_table(&mut self, name: &str, rows: &[impl Serialize]) -> Result<()> {
        let csv = csv_content(&self.path.join(name), rows)?;
        self.add(name, csv);
        Ok(())
    }

    /// Adds the tables of a study.
    pub fn add_files(&mut self, tables: TableFiles) {
        let tables = tables.into_iter();
        self.files
            .extend(tables.map(|(name, content)| (name.to_owned(), content)));
    }

    /// Adds a chart as PNG and as SVG; its name has no ending.
    pub fn add_chart(&mut self, name: &str, title: &str, drawing: &Drawing) -> Result<()> {
        self.add(format!("{name}.png"), drawing.png()?);
        self.add(format!("{name}.svg"), drawing.svg(title));
        Ok(())
    }

    /// Names and contents.
    pub fn files(&self) -> impl Iterator<Item = (&str, &[u8])> {
        let files = self.files.iter();
        files.map(|(name, content)| (name.as_str(), content.as_slice()))
    }

    /// Makes the folder if it is missing and writes every file whole; returns their paths. The error says if a file is in
    /// the way.
    pub fn write(self) -> Result<Vec<PathBuf>> {
        make_folder(self.path)?;
        let written = self.files.into_iter().map(|(name, content)| {
            let path = self.path.join(name);
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
