//! The pieces that a run does.

use crate::engine::attempt::attempt;
use crate::engine::progress::Progress;
use crate::engine::work_items::NamedPiece;
use crate::engine::work_items::record::{PieceResult, PieceRows};
use crate::engine::work_items::study_runner::PieceManner;
use crate::error::Result;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// The pieces that are left to a run, for whoever measures them: by their number among all pieces.
pub struct PiecesLeft<'a, R> {
    manner: PieceManner<'a>,
    /// What is told how far the run is. Each finished piece advances it by one.
    pub progress: &'a dyn Progress,
    pieces: &'a [NamedPiece],
    /// Of each piece.
    is_left: Vec<bool>,
    /// By number, once it is finished.
    results: Mutex<BTreeMap<usize, PieceResult<R>>>,
}

impl<'a, R: PieceRows> PiecesLeft<'a, R> {
    /// Some of all pieces.
    pub(crate) fn new(
        manner: &PieceManner<'a>,
        (pieces, is_left): (&'a [NamedPiece], Vec<bool>),
    ) -> Self {
        Self {
            manner: *manner,
            progress: manner.progress,
            pieces,
            is_left,
            results: Mutex::default(),
        }
    }

    /// How many there are.
    pub fn n(&self) -> usize {
        self.left().count()
    }

    /// Their numbers.
    fn left(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.pieces.len()).filter(|&number| self.is_left[number])
    }

    /// Whether a piece is to be done.
    pub fn has(&self, number: usize) -> bool {
        self.is_left[number]
    }

    /// Those of some things whose pieces are to be done, with their numbers: these go up from that of the first.
    pub fn of<T>(&self, first: usize, all: impl IntoIterator<Item = T>) -> Vec<(usize, T)> {
        let numbered = (first..).zip(all);
        numbered.filter(|(number, _)| self.has(*number)).collect()
    }

    /// Does a piece that is left, if it is, and keeps what came of it.
    ///
    /// # Errors
    /// The journal cannot be written; what went wrong, if the first failure ends the run.
    pub fn finish(&self, number: usize, measure: impl FnOnce() -> Result<R>) -> Result<()> {
        if !self.is_left[number] {
            return Ok(());
        }
        let result = attempt(self.manner.fail_fast, measure)?;
        self.keep(number, result)
    }

    /// What several pieces need first; if it cannot be had, all of them fail of it.
    ///
    /// # Errors
    /// As of [`finish`](Self::finish).
    pub fn prepare<T>(
        &self,
        numbers: &[usize],
        make: impl FnOnce() -> Result<T>,
    ) -> Result<Option<T>> {
        match attempt(self.manner.fail_fast, make)? {
            Ok(made) => Ok(Some(made)),
            Err(said) => {
                for &number in numbers.iter().filter(|&&number| self.is_left[number]) {
                    self.keep(number, Err(said.clone()))?;
                }
                Ok(None)
            }
        }
    }

    fn keep(&self, number: usize, result: PieceResult<R>) -> Result<()> {
        let piece = &self.pieces[number];
        debug_assert!(
            serde_json::to_string(&result)
                .is_ok_and(|json| serde_json::from_str::<PieceResult<R>>(&json).is_ok()),
            "rows of {} have a number that JSON has not: any_number writes it",
            piece.name
        );
        self.manner.journal.keep(&piece.key(), &result)?;
        // What a thread that panicked held is whole: nothing is inserted in parts.
        let results = self.results.lock();
        let mut results = results.unwrap_or_else(|poisoned| poisoned.into_inner());
        results.insert(number, result);
        self.progress.advance(1);
        self.progress.item_finished();
        Ok(())
    }

    /// Of each piece whether it was to be done, and what came of those that were and were not passed over, by number.
    pub(crate) fn into_results(self) -> (Vec<bool>, BTreeMap<usize, PieceResult<R>>) {
        let results = self.results.into_inner();
        let results = results.unwrap_or_else(|poisoned| poisoned.into_inner());
        (self.is_left, results)
    }
}
