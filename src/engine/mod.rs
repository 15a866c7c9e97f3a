//! Engine of all studies: axes, work items, the journal, shards, progress and provenance.
//!
//! The engine runs the [work items](work_items) of a study independently of what they measure. Each finished item is stored in the [`journal`], so that an
//! interrupted run can continue. Items are divided among shards ([`shard`]).

pub(crate) mod at_once;
pub mod axes;
pub mod axis;
pub mod journal;
pub(crate) mod program;
pub mod progress;
pub mod provenance;
pub mod shard;
pub mod work_items;
