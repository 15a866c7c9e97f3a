//! Pieces: a study's work in named parts that know nothing of each other.
//!
//! Every kind of study is a [`PieceStudy`]: it says which pieces there are, measures those that
//! are left, and makes its tables of their rows. The engine does all else: it keeps each piece in the [journal](crate::engine::journal) as soon as
//! it is finished and reads it from there when the study goes on, records what fails, and deals pieces out to shards.

pub mod any_number;
pub(crate) mod pending;
pub(crate) mod record;
pub(crate) mod scale;
pub(crate) mod shared;
pub(crate) mod study_runner;

pub use crate::engine::work_items::pending::PiecesLeft;
pub use crate::engine::work_items::record::PieceRows;
pub use crate::engine::work_items::scale::Scale;
pub use crate::engine::work_items::shared::Shared;
pub use crate::engine::work_items::study_runner::{
    Part, PieceFailure, PieceManner, PieceStudy, PiecesRun, run_whole,
};

use crate::inputs::content_hash::short_hash;

/// Hexadecimal digits of what a piece depends on. Fewer: two of one name may be taken for each other.
const CONTENT_DIGITS: usize = 16;

/// A piece of a study's work.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedPiece {
    /// What it is called; no two pieces of a study share a name.
    pub name: String,
    /// What its rows depend on beside its name and the keys of the study that may not change; nothing
    /// where these say all. Its number is no part of either: a study may have more pieces the next time.
    pub content: String,
    /// Number of its group, from 0 without gaps: pieces of a group share what has to be made before them, so that one shard does all of
    /// them as long as there is a group for every shard.
    pub group: usize,
}

impl NamedPiece {
    /// A piece whose name says all that it depends on.
    pub fn new(name: String, group: usize) -> Self {
        Self {
            name,
            content: String::new(),
            group,
        }
    }

    /// What a journal calls it.
    fn key(&self) -> String {
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
