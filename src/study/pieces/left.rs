//! The pieces that a run does.

use super::record::{PieceResult, PieceRows, keep};
use crate::error::Result;
use crate::study::attempt::attempt;
use crate::study::journal::Journal;
use crate::study::progress::Progress;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard};

/// The pieces that are left to a run, for whoever measures them.
pub struct PiecesLeft<'a, R> {
    journal: &'a Journal,
    fail_fast: bool,
    /// What is told how far the run is. Each finished piece advances it by one.
    pub progress: &'a dyn Progress,
    /// By name; none until a piece is finished.
    results: Mutex<BTreeMap<String, Option<PieceResult<R>>>>,
}

impl<'a, R: PieceRows> PiecesLeft<'a, R> {
    /// Of these names.
    pub(super) fn new(
        journal: &'a Journal,
        fail_fast: bool,
        progress: &'a dyn Progress,
        names: impl IntoIterator<Item = String>,
    ) -> Self {
        let results = names.into_iter().map(|name| (name, None)).collect();
        Self {
            journal,
            fail_fast,
            progress,
            results: Mutex::new(results),
        }
    }

    /// Whether a piece is to be done.
    pub fn has(&self, name: &str) -> bool {
        self.results().contains_key(name)
    }

    /// Those of some things whose pieces are to be done.
    pub fn of<T>(&self, all: impl IntoIterator<Item = T>, name: impl Fn(&T) -> String) -> Vec<T> {
        let all = all.into_iter();
        all.filter(|thing| self.has(&name(thing))).collect()
    }

    /// Does a piece that is left, if it is, and keeps what came of it.
    ///
    /// # Errors
    /// The journal cannot be written; what went wrong, if the first failure ends the run.
    pub fn finish(&self, name: &str, measure: impl FnOnce() -> Result<R>) -> Result<()> {
        if !self.has(name) {
            return Ok(());
        }
        let result = attempt(self.fail_fast, measure)?;
        self.keep(name, result)
    }

    /// What several pieces need first; if it cannot be had, all of them fail of it.
    ///
    /// # Errors
    /// As of [`finish`](Self::finish).
    pub fn prepare<T>(
        &self,
        names: &[String],
        make: impl FnOnce() -> Result<T>,
    ) -> Result<Option<T>> {
        match attempt(self.fail_fast, make)? {
            Ok(made) => Ok(Some(made)),
            Err(said) => {
                for name in names.iter().filter(|name| self.has(name)) {
                    self.keep(name, Err(said.clone()))?;
                }
                Ok(None)
            }
        }
    }

    fn keep(&self, name: &str, result: PieceResult<R>) -> Result<()> {
        keep(self.journal, name, &result)?;
        self.results().insert(name.to_owned(), Some(result));
        self.progress.advance(1);
        Ok(())
    }

    /// What came of every piece, by name.
    pub(super) fn into_results(self) -> BTreeMap<String, Option<PieceResult<R>>> {
        let results = self.results.into_inner();
        results.unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    fn results(&self) -> MutexGuard<'_, BTreeMap<String, Option<PieceResult<R>>>> {
        // What a thread that panicked held is whole: nothing is inserted in parts.
        self.results
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}
