//! A work item of a study.

use crate::inputs::content_hash::short_hash;

/// Hexadecimal digits of what a item depends on. Fewer: two of one name may be taken for each other.
const CONTENT_DIGITS: usize = 16;

/// A item of a study's work.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorkItem {
    /// The name. Items of one name have the same rows.
    pub name: String,
    /// What its rows depend on beside its name and the keys of the study that may not change; nothing
    /// where these say all. Its number is no part of either: a study may have more items the next time.
    pub content: String,
    /// Number of its group, from 0 without gaps: items of a group share what has to be made before them, so that one shard does all of
    /// them as long as there is a group for every shard.
    pub group: usize,
    /// Whether the rows are results. If not, the item makes what results need, and a study that shares no more than such items is another study.
    pub is_result: bool,
}

impl WorkItem {
    /// A item whose name says all that it depends on.
    pub fn new(name: String, group: usize) -> Self {
        Self {
            name,
            content: String::new(),
            group,
            is_result: true,
        }
    }

    /// What a journal calls it.
    pub(crate) fn key(&self) -> String {
        match self.content.is_empty() {
            true => format!("piece {}", self.name),
            false => format!("piece {} [{}]", self.name, self.content),
        }
    }

    /// The same, depending on something more.
    pub fn made_of(mut self, content: impl std::fmt::Debug) -> Self {
        self.content = short_hash(format!("{content:?}"), CONTENT_DIGITS);
        self
    }
}
