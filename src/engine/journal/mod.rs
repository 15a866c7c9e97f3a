//! Journal: what a run has finished, on disk as soon as it is finished, so that the next run goes on from there.
//!
//! A [`Journal`] is a file of lines beside the tables, one a finished piece of work, each with its checksum. Its first line
//! is the [`Identity`] of the study: a run on another study, other objects or by another program is refused, with what
//! differs, and so is a journal without such a line or with lines of two studies. What a line keeps goes by all that it depends on, so
//! that a study with more values on its axes, or more trials, goes on from what is there. A process that is killed loses the work in flight and nothing else: the line that it was writing is recognised as
//! torn, dropped, and its work done again.

pub(crate) mod identity;
pub(crate) mod journal_file;
pub(crate) mod line;
pub(crate) mod set_aside;

pub use crate::engine::journal::identity::{Identity, SameStudy};
pub use crate::engine::journal::journal_file::{JOURNAL_FILE, Journal};
pub use crate::engine::journal::line::Records;
pub use crate::engine::journal::set_aside::{check_set_aside, set_aside};
