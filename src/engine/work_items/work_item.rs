//! Work item: a named, independent part of the work of a study.

use crate::inputs::content_hash::short_hash;

/// Number of hexadecimal digits of the hash in a work item's key. With a smaller value, two items with one name may get equal keys.
const CONTENT_DIGITS: usize = 16;

/// Work item of a study: a named part that is computed, stored and repeated independently of others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorkItem {
    /// Name of the work item. Items with equal names have equal result rows.
    pub name: String,
    /// Inputs of the work item that are contained neither in its name nor in the fixed keys of the study; may be empty. The item's number is not an input,
    /// because a later study may have more items.
    pub content: String,
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
            content: String::new(),
            group,
            is_result: true,
        }
    }

    /// Returns the key under which the journal stores the result of the work item.
    pub(crate) fn key(&self) -> String {
        match self.content.is_empty() {
            true => format!("piece {}", self.name),
            false => format!("piece {} [{}]", self.name, self.content),
        }
    }

    /// Adds inputs that determine the result rows of the work item.
    pub fn made_of(mut self, content: impl std::fmt::Debug) -> Self {
        self.content = short_hash(format!("{content:?}"), CONTENT_DIGITS);
        self
    }
}
