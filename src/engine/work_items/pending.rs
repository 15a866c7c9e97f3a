//! Pending work items, which a run has yet to compute.

use crate::engine::isolated::run_isolated;
use crate::engine::progress::Progress;
use crate::engine::work_items::record::{ItemResult, ItemRows};
use crate::engine::work_items::run_options::RunOptions;
use crate::engine::work_items::work_item::WorkItem;
use crate::error::Result;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Work items that a run has yet to compute, identified by their numbers among all items of the study.
pub struct PendingItems<'a, R> {
    options: RunOptions<'a>,
    /// Receiver of progress reports; each finished item advances it by one step.
    pub progress: &'a dyn Progress,
    items: &'a [WorkItem],
    /// Whether each work item of the study is pending.
    is_pending: Vec<bool>,
    /// Results of the items that this run has finished, by item number.
    results: Mutex<BTreeMap<usize, ItemResult<R>>>,
}

impl<'a, R: ItemRows> PendingItems<'a, R> {
    /// Creates the list of the work items that are pending among all items.
    pub(crate) fn new(
        options: &RunOptions<'a>,
        (items, is_pending): (&'a [WorkItem], Vec<bool>),
    ) -> Self {
        Self {
            options: *options,
            progress: options.progress,
            items,
            is_pending,
            results: Mutex::default(),
        }
    }

    /// Returns the number of pending work items.
    pub fn n(&self) -> usize {
        self.pending().count()
    }

    /// Returns the numbers of the pending work items.
    fn pending(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.items.len()).filter(|&number| self.is_pending[number])
    }

    /// Returns whether the work item with this number is pending.
    pub fn has(&self, number: usize) -> bool {
        self.is_pending[number]
    }

    /// Returns the elements of `all` whose work items are pending, each with the number of its item. The work items of the elements are numbered consecutively
    /// from `first`.
    pub fn among<T>(&self, first: usize, all: impl IntoIterator<Item = T>) -> Vec<(usize, T)> {
        let numbered = (first..).zip(all);
        numbered.filter(|(number, _)| self.has(*number)).collect()
    }

    /// Computes a work item with `measure` and stores its result; does nothing if the item is not pending.
    ///
    /// # Errors
    /// If the journal cannot be written, or if `measure` fails and the first failure ends the run.
    pub fn finish(&self, number: usize, measure: impl FnOnce() -> Result<R>) -> Result<()> {
        if !self.is_pending[number] {
            return Ok(());
        }
        let result = run_isolated(self.options.fail_fast, measure)?;
        self.keep(number, result)
    }

    /// Computes data that several pending work items use. If `make` fails, all pending items in `numbers` are recorded as failed, and `None` is returned.
    ///
    /// # Errors
    /// If the journal cannot be written, or if `make` fails and the first failure ends the run.
    pub fn prepare<T>(
        &self,
        numbers: &[usize],
        make: impl FnOnce() -> Result<T>,
    ) -> Result<Option<T>> {
        match run_isolated(self.options.fail_fast, make)? {
            Ok(made) => Ok(Some(made)),
            Err(said) => {
                for &number in numbers.iter().filter(|&&number| self.is_pending[number]) {
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
        // The map is consistent even after a panic, because each insertion is one operation.
        let results = self.results.lock();
        let mut results = results.unwrap_or_else(|poisoned| poisoned.into_inner());
        results.insert(number, result);
        self.progress.advance(1);
        self.progress.item_finished();
        Ok(())
    }

    /// Returns whether each work item was pending, and the results of the finished work items by number.
    pub(crate) fn into_results(self) -> (Vec<bool>, BTreeMap<usize, ItemResult<R>>) {
        let results = self.results.into_inner();
        let results = results.unwrap_or_else(|poisoned| poisoned.into_inner());
        (self.is_pending, results)
    }
}
