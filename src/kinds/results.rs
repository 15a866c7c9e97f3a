//! The folder of a study of any kind.

use super::any_study::Outcome;
use super::kind::Kind;
use super::loaded::Loaded;
use crate::error::Result;
use crate::files::write_bytes;
use crate::report::csv_tables::FAILURES_FILE;
use crate::report::folder::Folder;
use crate::report::page::StudyAbout;
use crate::report::study_folder::{Beyond, Found, folder_with};
use crate::study::pieces::PieceFailure;
use crate::study::provenance::{MANIFEST_FILE, Manifest, PROGRAM};
use crate::study::sha256;
use crate::table::{File, Table};
use std::path::Path;

/// Work items that failed.
pub(super) const FAILURES: File<PieceFailure> =
    File::new(FAILURES_FILE, "What failed, and why", "");

impl<K: Kind> Loaded<K> {
    /// Charts, pictures and page, for a folder, with what is known of its run: nothing is written yet.
    pub(super) fn folder_of<'a>(
        &self,
        folder: &'a Path,
        of_run: StudyAbout,
        tables: &[Table],
    ) -> Result<Folder<'a>> {
        let wall_s = of_run.manifest.as_ref().and_then(Manifest::wall_s);
        let about = StudyAbout {
            question: self.facts.question.clone(),
            expected: self.facts.expected.clone(),
            wall_s: wall_s.unwrap_or(f64::NAN),
            program: PROGRAM.to_owned(),
            ..of_run
        };
        let found = Found {
            tables,
            charts: &self.kind.charts(tables),
            answers: &self.kind.answers(tables),
        };
        folder_with(folder, &about, &found, || {
            Ok(Beyond {
                pictures: self.kind.pictures(tables)?,
                sections: self.kind.sections(tables)?,
            })
        })
    }

    /// Writes what [`AnyStudy::write`](super::AnyStudy::write) does.
    pub(super) fn write_results(&self, dir: &Path, outcome: &Outcome, run: Manifest) -> Result<()> {
        let hashes = |repeats: bool| {
            let tables = outcome.tables.iter();
            let files = tables.filter(|t| t.repeats == repeats && !t.csv.is_empty());
            let hashes = files.map(|table| (table.file.to_owned(), sha256(&table.csv)));
            hashes.collect()
        };
        let words = |&(columns, method): &(&str, &str)| (columns.to_owned(), method.to_owned());
        let manifest = Manifest {
            seed: self.facts.seed,
            n_cells: self.pieces.len(),
            n_trials: 1,
            n_failed: outcome.n_failed,
            tables_sha256: hashes(true),
            times_sha256: hashes(false),
            methods: self.facts.methods.iter().map(words).collect(),
            ..run
        };
        let json = manifest.to_json();
        let of_run = StudyAbout {
            name: manifest.study.clone(),
            command: manifest.command.clone(),
            manifest: Some(manifest),
            ..StudyAbout::default()
        };
        let mut folder = Folder::of_tables(dir, &outcome.tables);
        folder.append(self.folder_of(dir, of_run, &outcome.tables)?);
        folder.write()?;
        write_bytes(&dir.join("study.toml"), self.facts.toml.as_bytes())?;
        write_bytes(&dir.join(MANIFEST_FILE), json.as_bytes())
    }
}
