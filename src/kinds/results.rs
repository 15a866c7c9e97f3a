//! The folder of a study of any kind.

use super::kind::Kind;
use super::loaded::Loaded;
use crate::error::Result;
use crate::report::csv_tables::FAILURES_FILE;
use crate::report::folder::Folder;
use crate::report::page::StudyAbout;
use crate::report::study_folder::{Beyond, Found, folder_with};
use crate::study::pieces::PieceFailure;
use crate::study::provenance::{Manifest, PROGRAM};
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
}
