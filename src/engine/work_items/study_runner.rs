//! Runs a study item by item.

use crate::engine::progress::Progress;
use crate::engine::work_items::pending::PendingItems;
use crate::engine::work_items::record::{ItemResult, ItemRows};
use crate::engine::work_items::run_options::{Part, RunOptions};
use crate::engine::work_items::work_item::WorkItem;
use crate::error::Result;
use crate::row;
use crate::table::Table;

/// A study that is ready to run, in items.
pub trait StudyRunner {
    /// What a item finds.
    type Rows: ItemRows;
    /// All items, in the order of their rows.
    fn work_items(&self) -> Vec<WorkItem>;

    /// Does every item that is left, in any order and on any threads; what several need is made for those that are left only.
    ///
    /// # Errors
    /// Those of [`PendingItems::finish`]; what no item can do without.
    fn measure(&self, left: &PendingItems<Self::Rows>) -> Result<()>;

    /// Gives the rows of a item, by its number, what its place among all items decides, such as numbers of cells: rows that the journal has
    /// may be of a study with other axes.
    fn place(&self, _number: usize, _rows: &mut Self::Rows) {}

    /// A item in words, by its number: for failures.
    fn words(&self, _number: usize, item: &WorkItem) -> String {
        item.name.clone()
    }

    /// The tables of the rows of all items, but for those that failed.
    ///
    /// # Errors
    /// A file that tables need cannot be read.
    fn tables(&self, rows: Self::Rows) -> Result<Vec<Table>>;
}

row! {
/// A item that failed: a row of `failures.csv`.
pub struct ItemFailure {
    /// The item, in words.
    work_item: String => Subject "work item";
    /// What went wrong.
    error: String => Note;
} }

/// A run of a study's items that has read its journal.
pub struct StudyRun<'a, S: StudyRunner> {
    study: &'a S,
    items: &'a [WorkItem],
    /// What came of each before.
    before: Vec<Option<ItemResult<S::Rows>>>,
    left: PendingItems<'a, S::Rows>,
}

impl<'a, S: StudyRunner> StudyRun<'a, S> {
    /// Of this study, with all its items.
    pub fn new(study: &'a S, items: &'a [WorkItem], options: &RunOptions<'a>) -> Self {
        let results = items.iter().map(|item| options.journal.get(&item.key()));
        let before: Vec<Option<ItemResult<S::Rows>>> = results.collect();
        let is_in = is_in(items, options.part);
        let is_left = before.iter().enumerate().map(|(number, result)| {
            let is_done = matches!(result, Some(Ok(_))) || (result.is_some() && !options.retries);
            !is_done && is_in(number)
        });
        Self {
            study,
            items,
            left: PendingItems::new(options, (items, is_left.collect())),
            before,
        }
    }

    /// How many items it will do.
    pub fn n_pending(&self) -> usize {
        self.left.n()
    }

    /// Does what the journal has not yet: rows of all items that did not fail, now or before, in the order of items, and those that failed.
    /// The rows but for times are the same as if all were done at once.
    ///
    /// # Errors
    /// The journal cannot be written; what a item fails of, if the first to fail ends the run; what no item can do without.
    pub fn run(self) -> Result<(S::Rows, Vec<ItemFailure>)> {
        let Self { study, left, .. } = self;
        left.progress.expect(left.n());
        if left.n() > 0 {
            study.measure(&left)?;
        }
        let (is_left, mut now) = left.into_results();
        let mut rows = S::Rows::default();
        let mut failures = Vec::new();
        for (number, (item, before)) in self.items.iter().zip(self.before).enumerate() {
            let passed_over = || Err("a defect of the program: it was passed over".to_owned());
            let result = match is_left[number] {
                true => Some(now.remove(&number).unwrap_or_else(passed_over)),
                false => before,
            };
            match result {
                Some(Ok(mut found)) => {
                    study.place(number, &mut found);
                    rows.append(found);
                }
                Some(Err(error)) => failures.push(ItemFailure {
                    work_item: study.words(number, item),
                    error,
                }),
                // It is of another shard.
                None => {}
            }
        }
        Ok((rows, failures))
    }
}

/// Runs a whole study at once, keeps nothing, and ends at the first item that fails.
///
/// # Errors
/// What a item fails of.
pub fn run_whole<S: StudyRunner>(study: &S, progress: &dyn Progress) -> Result<S::Rows> {
    let items = study.work_items();
    let run = StudyRun::new(study, &items, &RunOptions::whole(progress));
    Ok(run.run()?.0)
}

/// Whether a item, by its number, belongs to a part.
fn is_in<'a>(items: &'a [WorkItem], part: Part<'a>) -> impl Fn(usize) -> bool + 'a {
    let groups = items.iter().map(|item| item.group);
    let n_groups = groups.max().map_or(0, |last| last + 1);
    move |number| match part {
        Part::All => true,
        Part::Shard(shard) => shard.takes((items[number].group, n_groups), number),
        Part::Only(numbers) => numbers.contains(&number),
    }
}
