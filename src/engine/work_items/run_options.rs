//! Options of a run: which work items it computes, and where it keeps their results.

use crate::engine::journal::journal_file::Journal;
use crate::engine::progress::Progress;
use crate::engine::shard::Shard;
use std::collections::BTreeSet;

/// Which items of a study a run does.
#[derive(Clone, Copy, Debug)]
pub enum Part<'a> {
    /// All.
    All,
    /// One of several equal parts.
    Shard(Shard),
    /// Those of these numbers.
    Only(&'a BTreeSet<usize>),
}

/// How a run goes about its items.
#[derive(Clone, Copy)]
pub struct RunOptions<'a> {
    /// Where finished items are looked for and kept.
    pub journal: &'a Journal,
    /// Whether the first item that fails ends the run.
    pub fail_fast: bool,
    /// Whether items that failed in an earlier run are tried again.
    pub retries: bool,
    /// Which items to do.
    pub part: Part<'a>,
    /// What is told how far the run is.
    pub progress: &'a dyn Progress,
}

impl<'a> RunOptions<'a> {
    /// All at once; nothing is kept, and the first item that fails ends the run.
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
