//! The items that a run does.

use crate::engine::attempt::attempt;
use crate::engine::progress::Progress;
use crate::engine::work_items::record::{ItemResult, ItemRows};
use crate::engine::work_items::run_options::RunOptions;
use crate::engine::work_items::work_item::WorkItem;
use crate::error::Result;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// The items that are left to a run, for whoever measures them: by their number among all items.
pub struct PendingItems<'a, R> {
    options: RunOptions<'a>,
    /// What is told how far the run is. Each finished item advances it by one.
    pub progress: &'a dyn Progress,
    items: &'a [WorkItem],
    /// Of each item.
    is_left: Vec<bool>,
    /// By number, once it is finished.
    results: Mutex<BTreeMap<usize, ItemResult<R>>>,
}

impl<'a, R: ItemRows> PendingItems<'a, R> {
    /// Some of all items.
    pub(crate) fn new(
        options: &RunOptions<'a>,
        (items, is_left): (&'a [WorkItem], Vec<bool>),
    ) -> Self {
        Self {
            options: *options,
            progress: options.progress,
            items,
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
        (0..self.items.len()).filter(|&number| self.is_left[number])
    }

    /// Whether a item is to be done.
    pub fn has(&self, number: usize) -> bool {
        self.is_left[number]
    }

    /// Those of some things whose items are to be done, with their numbers: these go up from that of the first.
    pub fn of<T>(&self, first: usize, all: impl IntoIterator<Item = T>) -> Vec<(usize, T)> {
        let numbered = (first..).zip(all);
        numbered.filter(|(number, _)| self.has(*number)).collect()
    }

    /// Does a item that is left, if it is, and keeps what came of it.
    ///
    /// # Errors
    /// The journal cannot be written; what went wrong, if the first failure ends the run.
    pub fn finish(&self, number: usize, measure: impl FnOnce() -> Result<R>) -> Result<()> {
        if !self.is_left[number] {
            return Ok(());
        }
        let result = attempt(self.options.fail_fast, measure)?;
        self.keep(number, result)
    }

    /// What several items need first; if it cannot be had, all of them fail of it.
    ///
    /// # Errors
    /// As of [`finish`](Self::finish).
    pub fn prepare<T>(
        &self,
        numbers: &[usize],
        make: impl FnOnce() -> Result<T>,
    ) -> Result<Option<T>> {
        match attempt(self.options.fail_fast, make)? {
            Ok(made) => Ok(Some(made)),
            Err(said) => {
                for &number in numbers.iter().filter(|&&number| self.is_left[number]) {
                    self.keep(number, Err(said.clone()))?;
                }
                Ok(None)
            }
        }
    }

    fn keep(&self, number: usize, result: ItemResult<R>) -> Result<()> {
        let item = &self.items[number];
        debug_assert!(
            serde_json::to_string(&result)
                .is_ok_and(|json| serde_json::from_str::<ItemResult<R>>(&json).is_ok()),
            "rows of {} have a number that JSON has not: any_number writes it",
            item.name
        );
        self.options.journal.keep(&item.key(), &result)?;
        // What a thread that panicked held is whole: nothing is inserted in parts.
        let results = self.results.lock();
        let mut results = results.unwrap_or_else(|poisoned| poisoned.into_inner());
        results.insert(number, result);
        self.progress.advance(1);
        self.progress.item_finished();
        Ok(())
    }

    /// Of each item whether it was to be done, and what came of those that were and were not passed over, by number.
    pub(crate) fn into_results(self) -> (Vec<bool>, BTreeMap<usize, ItemResult<R>>) {
        let results = self.results.into_inner();
        let results = results.unwrap_or_else(|poisoned| poisoned.into_inner());
        (self.is_left, results)
    }
}
