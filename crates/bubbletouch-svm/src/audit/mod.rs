//! Statistics of labelled rows that an audit of a data set needs: nearest rows, scores of held-out rows, and permutation tests of readability.
//!
//! | function | input → output |
//! |---|---|
//! | [`nearest_rows`] | rows and fold numbers → the nearest other rows, and the nearest row in another fold |
//! | [`HeldOut::scores`](held_out::HeldOut::scores) | rows, labels and folds → scores of rows by a classifier that was trained without them |
//! | [`readability`] | rows and labels → the accuracy with which the label can be read, and its permutation p-value |
//!
//! All functions work on one block of rows or one fold, so that the caller can distribute the work over threads.

pub mod held_out;
pub mod nearest;
pub mod readable;

pub use nearest::{NearestRows, nearest_rows};
pub use readable::{Readability, readability};
