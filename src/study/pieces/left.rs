//! The pieces that a run does.

use super::NamedPiece;
use super::record::{PieceResult, PieceRows, keep};
use crate::error::Result;
use crate::study::attempt::attempt;
use crate::study::journal::Journal;
use crate::study::progress::Progress;
use crate::study::time_left::Piece;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard};
use std::time::Instant;

/// The pieces that are left to a run, for whoever measures them.
pub struct PiecesLeft<'a, R> {
    journal: &'a Journal,
    fail_fast: bool,
    /// What is told how far the run is. Each finished piece advances it by one.
    pub progress: &'a dyn Progress,
    /// By name.
    pieces: BTreeMap<String, NamedPiece>,
    /// By name, once it is finished.
    results: Mutex<BTreeMap<String, PieceResult<R>>>,
}

impl<'a, R: PieceRows> PiecesLeft<'a, R> {
    /// Of these names.
    pub(super) fn new(
        journal: &'a Journal,
        fail_fast: bool,
        progress: &'a dyn Progress,
        pieces: impl IntoIterator<Item = NamedPiece>,
    ) -> Self {
        let pieces = pieces.into_iter();
        Self {
            journal,
            fail_fast,
            progress,
            pieces: pieces.map(|piece| (piece.name.clone(), piece)).collect(),
            results: Mutex::default(),
        }
    }

    /// What each piece is planned to take.
    pub(super) fn work(&self) -> impl Iterator<Item = Piece> + '_ {
        self.pieces.values().map(|piece| piece.work)
    }

    /// How many there are.
    pub fn n(&self) -> usize {
        self.pieces.len()
    }

    /// Whether a piece is to be done.
    pub fn has(&self, name: &str) -> bool {
        self.pieces.contains_key(name)
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
        let Some(piece) = self.pieces.get(name) else {
            return Ok(());
        };
        let result = self.during(&piece.work, || attempt(self.fail_fast, measure))?;
        self.keep(piece, result)
    }

    /// Does some of what the study [shares](super::PieceStudy::shared_work), and tells how long it took.
    pub fn during<T>(&self, work: &Piece, make: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let made = make();
        let wall_s = start.elapsed().as_secs_f64();
        self.progress.worked(work, work.spent_s(wall_s));
        made
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
                for piece in names.iter().filter_map(|name| self.pieces.get(name)) {
                    self.keep(piece, Err(said.clone()))?;
                }
                Ok(None)
            }
        }
    }

    fn keep(&self, piece: &NamedPiece, result: PieceResult<R>) -> Result<()> {
        keep(self.journal, piece, &result)?;
        self.results().insert(piece.name.clone(), result);
        self.progress.advance(1);
        Ok(())
    }

    /// What came of every piece that was to be done, by name; none of one that was passed over.
    pub(super) fn into_results(self) -> BTreeMap<String, Option<PieceResult<R>>> {
        let names = self.pieces.into_keys();
        let results = self.results.into_inner();
        let mut results = results.unwrap_or_else(|poisoned| poisoned.into_inner());
        let found = names.map(|name| (results.remove(&name), name));
        found.map(|(result, name)| (name, result)).collect()
    }

    fn results(&self) -> MutexGuard<'_, BTreeMap<String, PieceResult<R>>> {
        // What a thread that panicked held is whole: nothing is inserted in parts.
        self.results
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}
