//! Type-erased studies, which all commands use.

use crate::engine::journal::identity::Identity;
use crate::engine::journal::journal_file::Journal;
use crate::engine::progress::Progress;
use crate::engine::provenance::Manifest;
use crate::engine::work_items::run_options::{Part, RunOptions};
use crate::error::{Error, Result};
use crate::report::page::StudyAbout;
use crate::report::study_content::ChartFormat;
use crate::table::Table;
use std::path::Path;

/// Type-erased study: a loaded and checked study of any kind.
pub trait AnyStudy: Send {
    /// Returns the identity of the study: hashes of all content on which its results depend.
    fn identity(&self) -> &Identity;

    /// Returns the number of work items of the study.
    fn n_all(&self) -> usize;

    /// Returns a text that describes the study before it runs: its question, its size and the memory that it needs.
    ///
    /// # Errors
    /// If the study does not fit into the memory limit.
    fn plan(&self) -> Result<String>;

    /// Returns the number of work items in `part` that have no result in the journal.
    fn n_pending(&self, part: Part, journal: &Journal) -> usize;

    /// Returns the number of work items in `part` without a successful result in the journal.
    fn n_without_success(&self, part: Part, journal: &Journal) -> usize;

    /// Checks what the work items in `part` that have no successful result in the journal need of the running program. Commands call this function before they
    /// write a file.
    ///
    /// # Errors
    /// If the running program cannot compute one of these work items, for example because it does not provide a classifier.
    fn check(&self, part: Part, journal: &Journal) -> Result<()> {
        let missing = self.check_elsewhere(part, journal)?;
        missing.into_iter().next().map_or(Ok(()), Err)
    }

    /// Checks what these work items need if they are computed on other machines. Returns an error for each program that this machine lacks and the other
    /// machines may have.
    ///
    /// # Errors
    /// If the running program cannot compute one of these work items on any machine.
    fn check_elsewhere(&self, part: Part, journal: &Journal) -> Result<Vec<Error>>;

    /// Runs the work items that have no result in the journal.
    ///
    /// # Errors
    /// If the journal cannot be written, or the memory does not suffice for a single item. If an item fails and the first failure ends the run.
    fn run(&self, options: &RunOptions) -> Result<Outcome>;

    /// Writes all files of a run into a result folder: tables, charts, page, study file and manifest.
    ///
    /// # Errors
    /// If a chart cannot be drawn or a file cannot be written.
    fn write(
        &self,
        folder: &Path,
        outcome: &Outcome,
        run: Manifest,
        chart_format: ChartFormat,
    ) -> Result<()>;

    /// Returns the text that the terminal shows at the end of a run, wrapped at `width` characters.
    fn words(&self, outcome: &Outcome, width: usize) -> String;

    /// Re-runs `n` work items, drawn at random with the seed `draw`, and compares their results with the stored ones. Returns a text that lists these items.
    ///
    /// # Errors
    /// If a recomputed row differs from the row in the folder.
    fn verify(&self, folder: &Path, n: usize, draw: u64, progress: &dyn Progress)
    -> Result<String>;

    /// Redraws the charts, pictures and page of a result folder from the tables in the folder. The question and the answers come from the study.
    ///
    /// # Errors
    /// If a table cannot be read or a file cannot be written.
    fn report(&self, folder: &Path, about: StudyAbout) -> Result<()>;
}

/// Result of running a study: its tables, and the number of failed work items.
pub struct Outcome {
    /// All result tables, including the table of failed work items.
    pub tables: Vec<Table>,
    /// Number of work items that failed.
    pub n_failed: usize,
}
