//! Handling of Ctrl-C and termination signals: files stay complete, and a message explains how to resume the run.

use crate::command::terminal::streams::note;
use bubbletouch::study::journal::Journal;
use bubbletouch::{Error, Result};
use std::sync::Arc;

/// Installs signal handlers that write the journal to the disk before a signal ends the process.
pub fn keep_journal_on_signals(journal: &Arc<Journal>) -> Result<()> {
    let journal = Arc::clone(journal);
    let set = ctrlc::set_handler(move || {
        let synced = journal.stop();
        note("\nstopped: finished work items are kept; the same command continues the run");
        if let Err(error) = synced {
            note(format_args!("error: {error}"));
        }
        std::process::exit(130);
    });
    set.map_err(|error| Error::io("signals", "listen", std::io::Error::other(error)))
}
