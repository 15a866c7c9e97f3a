//! What a running study tells whoever listens: which stage it is in, and how far.

use super::time_left::Piece;

/// A listener to the stages of a run. Calls come from one thread at a time for `stage` and `finish`, from any thread for
/// `advance`.
pub trait Progress: Sync {
    /// A stage begins; it will advance `total` steps. A stage that is still open ends.
    fn stage(&self, name: &str, total: u64);
    /// `n` more steps of the stage are done.
    fn advance(&self, n: u64);
    /// The run will do this work; told once, before its first stage, by runs that know.
    fn expect(&self, _work: &[Piece]) {}
    /// A piece of that work is done, or a part of one, and took so many seconds on its thread. Calls come from any thread.
    fn worked(&self, _piece: &Piece, _took_s: f64) {}
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
