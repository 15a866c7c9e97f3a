//! Options of a run: which work items it computes, and where it keeps their results.

use crate::engine::journal::journal_file::Journal;
use crate::engine::progress::Progress;
use crate::engine::shard::Shard;
use std::collections::BTreeSet;

/// Work items of a study that a run computes.
#[derive(Clone, Copy, Debug)]
pub enum Part<'a> {
    /// All items.
    All,
    /// The items of one shard.
    Shard(Shard),
    /// The items with these numbers.
    Only(&'a BTreeSet<usize>),
}

/// Options of a run.
#[derive(Clone, Copy)]
pub struct RunOptions<'a> {
    /// Journal from which finished items are read and in which new ones are stored.
    pub journal: &'a Journal,
    /// Whether the first failure of an item ends the run.
    pub fail_fast: bool,
    /// Whether items that failed in an earlier run are computed again.
    pub retries: bool,
    /// Items to compute.
    pub part: Part<'a>,
    /// Receiver of progress reports.
    pub progress: &'a dyn Progress,
}

impl<'a> RunOptions<'a> {
    /// Returns options that compute all items without a journal; the first failure ends the run.
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
