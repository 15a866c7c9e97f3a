//! Statistics of labelled rows that an audit of a data set needs: nearest rows, predictions of held-out rows, and permutation tests.
//!
//! | function | input → output |
//! |---|---|
//! | [`nearest_rows`] | rows and fold numbers → the nearest other rows, and the nearest row in another fold |
//! | [`HeldOut::predicted`](held_out::HeldOut::predicted) | rows, labels and folds → classes of rows by a classifier that was trained without them |
//! | [`permute`] | a statistic of the data and of permutations → p-value |
//! | [`readability`] | rows, labels and units → the accuracy with which the label can be read, and its p-value |
//! | [`held_out_loss`] | rows, labels and folds → the accuracy that whole folds cost, and its p-value |
//!
//! All functions work on one block of rows, one fold or one test, so that the caller can distribute the work over threads.

pub mod held_out;
pub mod nearest;
pub mod permutation;
pub mod readable;

pub use nearest::{NearestRows, nearest_rows};
pub use permutation::{Permuted, Units, exchange_within, permute};
pub use readable::{Readability, held_out_loss, readability};
