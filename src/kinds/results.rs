//! The folder of a study of any kind.

use super::any_study::{AnyOutcome, EndedRun};
use super::kind::Kind;
use super::loaded::Loaded;
use crate::error::Result;
use crate::files::write_bytes;
use crate::report::csv_tables::{FAILURES_FILE, TableHashes, read_rows};
use crate::report::folder::Folder;
use crate::report::page::StudyAbout;
use crate::report::study_folder::{Beyond, Found, folder_with};
use crate::study::pieces::PieceFailure;
use crate::study::provenance::{MANIFEST_FILE, Manifest, PROGRAM};
use crate::table::Table;
use std::path::Path;

/// What came of a study.
pub struct Results<'a, K> {
    pub study: &'a Loaded<K>,
    pub tables: Vec<Table>,
    pub n_failed: usize,
}

/// Work items that failed.
pub fn failures_table(failures: &[PieceFailure]) -> Result<Table> {
    Table::of(FAILURES_FILE, "What failed, and why", failures)
}

/// The same, of a folder; none where no run left the file.
pub fn read_failures(folder: &Path) -> Result<Option<Table>> {
    let path = folder.join(FAILURES_FILE);
    match path.exists() {
        true => failures_table(&read_rows(&path)?).map(Some),
        false => Ok(None),
    }
}

impl<K: Kind> Loaded<K> {
    /// Charts, pictures and page, for a folder: nothing is written yet.
    pub(super) fn folder_of<'a>(
        &self,
        folder: &'a Path,
        about: &StudyAbout,
        tables: &[Table],
    ) -> Result<Folder<'a>> {
        let found = Found {
            tables,
            charts: &self.kind.charts(tables),
            answers: &self.kind.answers(tables),
        };
        folder_with(folder, about, &found, || {
            Ok(Beyond {
                pictures: self.kind.pictures(tables)?,
                sections: self.kind.sections(tables)?,
            })
        })
    }
}

impl<K: Kind> Results<'_, K> {
    fn manifest(&self, ended: &EndedRun) -> Manifest {
        let Loaded {
            facts, identity, ..
        } = self.study;
        let files = self.tables.iter().filter(|table| !table.csv.is_empty());
        let files = files.map(|table| (table.file, table.csv.clone()));
        let of_name = |name: &str| self.tables.iter().find(|table| table.file == name);
        let hashes = TableHashes::of(files, |name| of_name(name).is_some_and(|t| t.repeats));
        let methods = facts.methods.iter();
        Manifest {
            study: ended.name.clone(),
            command: ended.command.clone(),
            paths_from: ended.paths_from.clone(),
            seed: facts.seed,
            n_cells: self.study.pieces.len(),
            n_trials: 1,
            n_finished_before: ended.n_before,
            n_failed: self.n_failed,
            tables_sha256: hashes.repeatable,
            times_sha256: hashes.times,
            methods: methods
                .map(|(columns, method)| (columns.to_string(), method.to_string()))
                .collect(),
            ..Manifest::ended(identity, ended.started)
        }
    }
}

impl<K: Kind> AnyOutcome for Results<'_, K> {
    fn n_failed(&self) -> usize {
        self.n_failed
    }

    fn write(&self, ended: &EndedRun) -> Result<()> {
        let facts = &self.study.facts;
        let manifest = self.manifest(ended);
        let about = StudyAbout {
            name: ended.name.clone(),
            question: facts.question.clone(),
            expected: facts.expected.clone(),
            wall_s: ended.wall_s(),
            command: ended.command.clone(),
            program: PROGRAM.to_owned(),
            manifest: Some(manifest.clone()),
            all_charts: false,
        };
        let mut folder = Folder::of_tables(ended.folder, &self.tables);
        folder.append(self.study.folder_of(ended.folder, &about, &self.tables)?);
        folder.write()?;
        write_bytes(&ended.folder.join("study.toml"), facts.toml.as_bytes())?;
        write_bytes(
            &ended.folder.join(MANIFEST_FILE),
            manifest.to_json().as_bytes(),
        )
    }

    fn words(&self, width: usize) -> String {
        let found = self.study.kind.summary(&self.tables, width);
        format!("{}\n\n{found}", self.study.facts.question)
    }
}
