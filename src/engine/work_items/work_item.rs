//! Work item: a named, independent part of the work of a study.

use crate::inputs::content_hash::short_hash;
use serde::Serialize;

/// Number of hexadecimal digits of the hash in a work item's key. With a smaller value, two items with one name may get equal keys.
const INPUT_DIGITS: usize = 16;

/// Work item of a study: a named part that is computed, stored and repeated independently of others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorkItem {
    /// Name of the work item. Items with equal names have equal result rows.
    pub name: String,
    /// Identity of the inputs that the name does not contain: the hash of their canonical bytes (JSON); may be empty. The item's number is not an input,
    /// because a later study may have more items.
    pub inputs: String,
    /// Number of the group to which the item belongs, from 0 without gaps. Items of a group share preparatory work, so one shard computes all of them if there
    /// are enough groups for every shard.
    pub group: usize,
    /// Whether the rows of the work item are results of the study. If false, the item only prepares data for results; studies that share only preparing items
    /// are different studies.
    pub is_result: bool,
}

impl WorkItem {
    /// Creates a work item; its name must describe all inputs of its rows.
    pub fn new(name: String, group: usize) -> Self {
        Self {
            name,
            inputs: String::new(),
            group,
            is_result: true,
        }
    }

    /// Creates a work item whose rows depend on `inputs`; its name only needs to describe it in words. Items with equal names and equal inputs have equal rows.
    pub fn of(name: String, group: usize, inputs: &impl Serialize) -> Self {
        let bytes = serde_json::to_vec(inputs).expect("inputs are plain values");
        Self {
            inputs: short_hash(bytes, INPUT_DIGITS),
            ..Self::new(name, group)
        }
    }

    /// Returns the key under which the journal stores the result of the work item.
    pub(crate) fn key(&self) -> String {
        match self.inputs.is_empty() {
            true => format!("piece {}", self.name),
            false => format!("piece {} [{}]", self.name, self.inputs),
        }
    }
}
