//! Run of a study's work items; results that the journal already contains are reused.

use crate::engine::work_items::pending::{Part, PendingItems, RunOptions};
use crate::engine::work_items::record::{ItemResult, ItemRows};
use crate::engine::work_items::work_item::WorkItem;
use crate::error::Result;
use crate::row;

row! {
/// Failed work item, as a row of the table `failures.csv`.
pub struct ItemFailure {
    /// Name of the work item, in words.
    work_item: String => Subject "work item";
    /// Message of the error that ended the work item.
    error: String => Note;
} }

/// Run of a study's work items, which is created after the journal was read.
pub struct StudyRun<'a, R> {
    items: &'a [WorkItem],
    /// Result of each work item in the journal; `None` if the journal contains no result of the item.
    before: Vec<Option<ItemResult<R>>>,
    pending: PendingItems<'a, R>,
}

impl<'a, R: ItemRows> StudyRun<'a, R> {
    /// Creates the run of work items, with the results that the journal in the options contains.
    pub fn new(items: &'a [WorkItem], options: &RunOptions<'a>) -> Self {
        let results = items.iter().map(|item| options.journal.get(&item.key()));
        let before: Vec<Option<ItemResult<R>>> = results.collect();
        let is_in = is_in(items, options.part);
        let is_pending = before.iter().enumerate().map(|(number, result)| {
            let is_done = matches!(result, Some(Ok(_))) || (result.is_some() && !options.retries);
            !is_done && is_in(number)
        });
        Self {
            items,
            pending: PendingItems::new(options, (items, is_pending.collect())),
            before,
        }
    }

    /// Returns the work items that the run computes.
    pub fn pending(&self) -> &PendingItems<'a, R> {
        &self.pending
    }

    /// Computes the pending work items by `measure` and returns all rows of the study. The rows belong to all items that did not fail in this or an earlier
    /// run, in the order of items. Failed items are also returned. Except for times, the rows equal the rows of a run that computes all items together.
    ///
    /// `place(number, rows)` sets the values in the rows that depend on the item's number, such as numbers of configurations. `words(number)` returns the name
    /// of an item in words, for failures.
    ///
    /// # Errors
    /// If the journal cannot be written, if an item fails and the first failure ends the run, or if `measure` fails as a whole.
    pub fn run(
        self,
        measure: impl FnOnce(&PendingItems<R>) -> Result<()>,
        place: impl Fn(usize, &mut R),
        words: impl Fn(usize) -> String,
    ) -> Result<(R, Vec<ItemFailure>)> {
        let Self { pending, .. } = self;
        pending.progress.expect(pending.n());
        if pending.n() > 0 {
            measure(&pending)?;
        }
        let (is_pending, mut now) = pending.into_results();
        let mut rows = R::default();
        let mut failures = Vec::new();
        for (number, before) in (0..self.items.len()).zip(self.before) {
            let passed_over = || Err("a defect of the program: it was passed over".to_owned());
            let result = match is_pending[number] {
                true => Some(now.remove(&number).unwrap_or_else(passed_over)),
                false => before,
            };
            match result {
                Some(Ok(mut found)) => {
                    place(number, &mut found);
                    rows.append(found);
                }
                Some(Err(error)) => failures.push(ItemFailure {
                    work_item: words(number),
                    error,
                }),
                // The item belongs to another shard.
                None => {}
            }
        }
        Ok((rows, failures))
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
