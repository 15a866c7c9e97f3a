//! Progress of a study: the current stage and the number of completed steps.

/// Receiver of progress reports during a run. The methods `stage` and `finish` are called by one thread at a time, `advance` by any thread.
pub trait Progress: Sync {
    /// Starts a stage that consists of `total` steps, and ends the previous stage.
    fn stage(&self, name: &str, total: u64);
    /// Advances the current stage by `n` steps.
    fn advance(&self, n: u64);
    /// Sets the number of work items in the run; called once, before the first stage.
    fn expect(&self, _n_items: usize) {}
    /// Counts one work item as finished; may be called by any thread.
    fn item_finished(&self) {}
    /// Ends the last stage of the run; `message` describes the result.
    fn finish(&self, message: &str);
}

/// Receiver that ignores all progress reports, for tests, libraries and `--quiet`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn stage(&self, _name: &str, _total: u64) {}
    fn advance(&self, _n: u64) {}
    fn finish(&self, _message: &str) {}
}
