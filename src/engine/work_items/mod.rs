//! Work items: named, independent parts of a study's work.
//!
//! A study lists its work items, computes the pending ones, and makes tables from their rows. A [`StudyRun`] stores each finished item in the journal, reads
//! stored items when the study continues, records failures, and divides items among shards.

pub use crate::engine::work_items::work_item::WorkItem;
pub mod any_number;
pub(crate) mod pending;
pub(crate) mod record;
pub(crate) mod scale;
pub(crate) mod shared;
pub(crate) mod study_run;
pub(crate) mod work_item;

pub use crate::engine::work_items::pending::{Part, PendingItems, RunOptions};
pub use crate::engine::work_items::record::ItemRows;
pub use crate::engine::work_items::scale::{Scale, Stage};
pub use crate::engine::work_items::shared::Shared;
pub use crate::engine::work_items::study_run::{ItemFailure, StudyRun};
