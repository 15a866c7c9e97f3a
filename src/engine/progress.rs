//! What a running study tells whoever listens: which stage it is in, and how far.

/// A listener to the stages of a run. Calls come from one thread at a time for `stage` and `finish`, from any thread for
/// `advance`.
pub trait Progress: Sync {
    /// A stage begins; it will advance `total` steps. A stage that is still open ends.
    fn stage(&self, name: &str, total: u64);
    /// `n` more steps of the stage are done.
    fn advance(&self, n: u64);
    /// Announces the number of work items of a run. It is called once, before the first stage.
    fn expect(&self, _n_items: usize) {}
    /// Counts one of these work items as finished. Calls come from any thread.
    fn item_finished(&self) {}
    /// The last stage ends; the message says what came of the run.
    fn finish(&self, message: &str);
}

/// Listens to nothing: for tests, libraries and `--quiet`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn stage(&self, _name: &str, _total: u64) {}
    fn advance(&self, _n: u64) {}
    fn finish(&self, _message: &str) {}
}
