//! A study of any kind, as the commands see it.

use crate::engine::journal::identity::Identity;
use crate::engine::journal::journal_file::Journal;
use crate::engine::progress::Progress;
use crate::engine::provenance::Manifest;
use crate::engine::work_items::run_options::{Part, RunOptions};
use crate::error::Result;
use crate::report::chart_format::ChartFormat;
use crate::report::page::StudyAbout;
use crate::table::Table;
use std::path::Path;

/// A study that is loaded and checked.
pub trait AnyStudy: Send {
    /// What its results depend on.
    fn identity(&self) -> &Identity;

    /// How many work items it has.
    fn n_all(&self) -> usize;

    /// What it asks, and what it will take.
    ///
    /// # Errors
    /// It cannot be done within the memory that it may take.
    fn plan(&self) -> Result<String>;

    /// Of a part, those of which a journal does not say what came of them.
    fn n_pending(&self, part: Part, journal: &Journal) -> usize;

    /// Returns the number of work items in `part` that have not succeeded according to the journal.
    fn n_without_success(&self, part: Part, journal: &Journal) -> usize;

    /// Does what is left.
    ///
    /// # Errors
    /// The journal cannot be written; what an item fails of, if the first to fail ends the run; too little memory for any item.
    fn run(&self, options: &RunOptions) -> Result<Outcome>;

    /// Writes tables, charts and page, the study and the manifest, of which what is known of the run is given.
    ///
    /// # Errors
    /// What cannot be drawn; a file that cannot be written.
    fn write(
        &self,
        folder: &Path,
        outcome: &Outcome,
        run: Manifest,
        chart_format: ChartFormat,
    ) -> Result<()>;

    /// What a person reads at the end, in lines of about `width` letters.
    fn words(&self, outcome: &Outcome, width: usize) -> String;

    /// Runs `n` items again that are drawn by `draw`, and says what they were.
    ///
    /// # Errors
    /// A row of a folder that is not the same again.
    fn verify(&self, folder: &Path, n: usize, draw: u64, progress: &dyn Progress)
    -> Result<String>;

    /// Writes the charts, pictures and page of a folder again, from its tables; question and answers are the study's.
    ///
    /// # Errors
    /// A table that cannot be read; a file that cannot be written.
    fn report(&self, folder: &Path, about: StudyAbout) -> Result<()>;
}

/// What came of a study.
pub struct Outcome {
    /// All tables, that of what failed among them.
    pub tables: Vec<Table>,
    /// How many work items failed.
    pub n_failed: usize,
}
