//! Run of a study: its options, and the work items that it has yet to compute. Results that the journal already contains are reused.

use crate::engine::journal::journal_file::Journal;
use crate::engine::progress::Progress;
use crate::engine::shard::Shard;
use crate::engine::work_items::work_item::{ItemResult, ItemRows, WorkItem};
use crate::error::Result;
use crate::row;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};

/// Selection of the work items that a run of a study computes.
#[derive(Clone, Copy, Debug)]
pub enum Part<'a> {
    /// All work items of the study are computed.
    All,
    /// Only the work items of one shard are computed.
    Shard(Shard),
    /// Only the work items with the given numbers are computed.
    Only(&'a BTreeSet<usize>),
}

/// Options of a run: journal, treatment of failures, selection of work items, and progress.
#[derive(Clone, Copy)]
pub struct RunOptions<'a> {
    /// Journal that contains finished work items and stores new ones.
    pub journal: &'a Journal,
    /// Whether the first failed work item ends the run.
    pub fail_fast: bool,
    /// Whether work items that failed in an earlier run are computed again.
    pub retries: bool,
    /// Selection of the work items that the run has to compute.
    pub part: Part<'a>,
    /// Receiver of progress reports.
    pub progress: &'a dyn Progress,
}

impl<'a> RunOptions<'a> {
    /// Returns options for computing all work items of a study without a journal; the first failure ends the run.
    pub fn whole(progress: &'a dyn Progress) -> Self {
        Self {
            journal: Journal::none(),
            fail_fast: true,
            retries: false,
            part: Part::All,
            progress,
        }
    }
}

row! {
/// Failed work item, as a row of the table `failures.csv`.
pub struct ItemFailure {
    /// Name of the work item, in words.
    work_item: String => Subject "work item";
    /// Message of the error that ended the work item.
    error: String => Note;
} }

/// Work items that a run has yet to compute, identified by their numbers among all items of the study.
pub struct PendingItems<'a, R> {
    options: RunOptions<'a>,
    /// Receiver of progress reports; each finished item advances it by one step.
    pub progress: &'a dyn Progress,
    items: &'a [WorkItem],
    /// Whether each work item of the study is pending.
    is_pending: Vec<bool>,
    /// Result of each work item, of an earlier run or of this one; `None` if the item is unfinished.
    results: Mutex<Vec<Option<ItemResult<R>>>>,
}

impl<'a, R: ItemRows> PendingItems<'a, R> {
    /// Creates the list of the work items in the part that the options select. Items that have a result in the journal are not pending.
    pub fn new(items: &'a [WorkItem], options: &RunOptions<'a>) -> Self {
        let in_journal = items.iter().map(|item| options.journal.get(&item.key()));
        let mut results: Vec<Option<ItemResult<R>>> = in_journal.collect();
        let is_in = is_in(items, options.part);
        let take_pending = |(number, result): (usize, &mut Option<ItemResult<R>>)| {
            let is_done = result
                .as_ref()
                .is_some_and(|found| found.is_ok() || !options.retries);
            let is_pending = !is_done && is_in(number);
            if is_pending {
                *result = None;
            }
            is_pending
        };
        Self {
            options: *options,
            progress: options.progress,
            items,
            is_pending: results.iter_mut().enumerate().map(take_pending).collect(),
            results: Mutex::new(results),
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

    /// Starts a stage of the run, which computes those of the given work items that are pending.
    pub fn stage(&self, name: &str, numbers: impl IntoIterator<Item = usize>) {
        let pending = numbers.into_iter().filter(|&number| self.has(number));
        self.progress.stage(name, pending.count() as u64);
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

    /// Computes all pending work items as a stage of the given name; `inputs` has the inputs of each work item of the study. Items are distributed one by one
    /// among the threads, because their times may differ much.
    ///
    /// # Errors
    /// If the journal cannot be written, or if `measure` fails and the first failure ends the run.
    pub fn each<I: Sync>(
        &self,
        stage: &str,
        inputs: &[I],
        measure: impl Fn(&I) -> Result<R> + Sync,
    ) -> Result<()> {
        self.progress.stage(stage, self.n() as u64);
        let inputs = inputs.par_iter().enumerate().with_max_len(1);
        inputs.try_for_each(|(number, inputs)| self.finish(number, || measure(inputs)))
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
        // The list is consistent even after a panic, because each change is one assignment.
        let mut results = self.results.lock().unwrap_or_else(PoisonError::into_inner);
        results[number] = Some(result);
        self.progress.advance(1);
        self.progress.item_finished();
        Ok(())
    }

    /// Returns all rows of the study, and the failed work items. The rows belong to all items that did not fail in this or an earlier run, in the order of
    /// items. Except for times, they equal the rows of a run that computes all items together.
    ///
    /// `place(number, rows)` sets the values in the rows that depend on the item's number, such as numbers of configurations. `words(number)` returns the name
    /// of an item in words, for failures.
    pub fn into_rows(
        self,
        place: impl Fn(usize, &mut R),
        words: impl Fn(usize) -> String,
    ) -> (R, Vec<ItemFailure>) {
        let results = self.results.into_inner();
        let results = results.unwrap_or_else(PoisonError::into_inner);
        let mut rows = R::default();
        let mut failures = Vec::new();
        for (number, result) in results.into_iter().enumerate() {
            let error = match result {
                Some(Ok(mut found)) => {
                    place(number, &mut found);
                    rows.append(found);
                    continue;
                }
                Some(Err(error)) => error,
                None if self.is_pending[number] => {
                    "a defect of the program: it was passed over".to_owned()
                }
                // The item belongs to another shard.
                None => continue,
            };
            failures.push(ItemFailure {
                work_item: words(number),
                error,
            });
        }
        (rows, failures)
    }
}

/// Returns a function that returns whether a work item, given by its number, belongs to `part`.
fn is_in<'a>(items: &'a [WorkItem], part: Part<'a>) -> impl Fn(usize) -> bool + 'a {
    let groups = items.iter().map(|item| item.group);
    let n_groups = groups.max().map_or(0, |last| last + 1);
    move |number| match part {
        Part::All => true,
        Part::Shard(shard) => shard.takes((items[number].group, n_groups), number),
        Part::Only(numbers) => numbers.contains(&number),
    }
}

/// Runs `work` and returns its result. An error or a panic is converted to a message, so that one failed work item does not end a long run. If `fail_fast` is true, a failure is returned as an error.
fn run_isolated<T>(
    fail_fast: bool,
    work: impl FnOnce() -> Result<T>,
) -> Result<std::result::Result<T, String>> {
    if fail_fast {
        return work().map(Ok);
    }
    Ok(match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(found)) => Ok(found),
        Ok(Err(error)) => Err(error.to_string()),
        Err(panic) => Err(format!("a defect of the program: {}", words(&*panic))),
    })
}

/// Returns the message of a panic as text.
fn words(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("it did not say why")
}
