//! Engine of all studies: axes, work items, the journal, shards, progress and provenance.
//!
//! The engine runs the [work items](work_items) of a study independently of what they measure. It stores each finished item in the [`journal`], so that an
//! interrupted run continues, and divides items among shards ([`shard`]).

pub mod axes;
pub mod axis;
pub(crate) mod isolated;
pub mod journal;
pub(crate) mod program;
pub mod progress;
pub mod provenance;
pub mod shard;
pub mod work_items;
