//! Work items: a study's work in named parts that know nothing of each other.
//!
//! Every kind of study is a [`StudyRunner`]: it says which items there are, measures those that
//! are left, and makes its tables of their rows. The engine does all else: it keeps each item in the [journal](crate::engine::journal) as soon as
//! it is finished and reads it from there when the study goes on, records what fails, and deals items out to shards.

pub use crate::engine::work_items::work_item::WorkItem;
pub mod any_number;
pub(crate) mod pending;
pub(crate) mod record;
pub(crate) mod run_options;
pub(crate) mod scale;
pub(crate) mod shared;
pub(crate) mod study_runner;
pub(crate) mod work_item;

pub use crate::engine::work_items::pending::PendingItems;
pub use crate::engine::work_items::record::ItemRows;
pub use crate::engine::work_items::run_options::{Part, RunOptions};
pub use crate::engine::work_items::scale::Scale;
pub use crate::engine::work_items::shared::Shared;
pub use crate::engine::work_items::study_runner::{ItemFailure, StudyRun, StudyRunner, run_whole};
