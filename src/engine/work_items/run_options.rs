//! Options of a run: the work items to compute, and the place where their results are stored.

use crate::engine::journal::journal_file::Journal;
use crate::engine::progress::Progress;
use crate::engine::shard::Shard;
use std::collections::BTreeSet;

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
