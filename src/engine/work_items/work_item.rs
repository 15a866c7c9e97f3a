//! Work item: a named, independent part of the work of a study.

use crate::inputs::content_hash::identity;
use serde::Serialize;

/// Work item of a study: a named part that is computed, stored and repeated independently of others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorkItem {
    /// Name of the work item, in words.
    pub name: String,
    /// Identity of the inputs of the work item: the hash of their canonical bytes (JSON). Items with equal names and equal inputs have equal result rows. The
    /// item's number is not an input, because a later study may have more items.
    pub inputs: String,
    /// Number of the group to which the item belongs, from 0 without gaps. Items of a group share preparatory work, so one shard computes all of them if there
    /// are enough groups for every shard.
    pub group: usize,
    /// Whether the rows of the work item are results of the study. If false, the item only prepares data for results; studies that share only preparing items
    /// are different studies.
    pub is_result: bool,
}

impl WorkItem {
    /// Creates a work item whose rows depend on `inputs`; its name only needs to describe it in words. Items with equal names and equal inputs have equal rows.
    pub fn of(name: String, group: usize, inputs: &impl Serialize) -> Self {
        Self {
            name,
            inputs: identity(inputs),
            group,
            is_result: true,
        }
    }

    /// Returns the key under which the journal stores the result of the work item.
    pub(crate) fn key(&self) -> String {
        format!("piece {} [{}]", self.name, self.inputs)
    }
}
