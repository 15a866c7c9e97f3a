//! Journal of finished results on disk, so that an interrupted run can be resumed.
//!
//! A [`Journal`] is a text file beside the tables, with one line and one checksum for each finished work item. The first line of a journal is the [`Identity`]
//! of the study. A run of another study, with other objects or by another program, is rejected with a list of the differences. A journal without such a line,
//! or with lines of two studies, is also rejected.
//!
//! The key of a line depends on all inputs of the result. A study with additional axis values or trials therefore reuses the existing results. If a process is
//! killed, only the unfinished work items are lost. An incomplete last line is removed, and its item is computed again.

pub(crate) mod identity;
pub(crate) mod journal_file;
pub(crate) mod line;
pub(crate) mod rename_old_results;

pub use crate::engine::journal::identity::Identity;
pub use crate::engine::journal::journal_file::{JOURNAL_FILE, Journal};
pub use crate::engine::journal::line::Records;
pub use crate::engine::journal::rename_old_results::{check_set_aside, rename_old_results};
