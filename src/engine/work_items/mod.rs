//! Work items: named, independent parts of a study's work.
//!
//! A study lists its work items, computes the pending ones, and makes tables from their rows. [`PendingItems`] stores each finished item in the journal, reads
//! stored items when the study continues, records failures, and divides items among shards.

pub mod any_number;
mod pending;
mod scale;
mod work_item;

pub use pending::{ItemFailure, Part, PendingItems, RunOptions};
pub use scale::{Scale, Stage};
pub(crate) use scale::{threads_within, within_memory};
pub use work_item::{ItemRows, Shared, WorkItem};
