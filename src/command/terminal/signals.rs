//! Handling of Ctrl-C and termination signals: files stay complete, and a message explains how to resume the run.

use crate::command::terminal::streams::note;
use bubbletouch::study::journal::Journal;
use bubbletouch::{Error, Result};
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// Journal of the command that runs; `None` before the signal handlers are installed.
static JOURNAL: Mutex<Option<Weak<Journal>>> = Mutex::new(None);

/// Sets the journal that is written to the disk before a signal ends the process. The first call installs the signal handlers.
pub fn keep_journal_on_signals(journal: &Arc<Journal>) -> Result<()> {
    let current = || JOURNAL.lock().unwrap_or_else(PoisonError::into_inner);
    if current().replace(Arc::downgrade(journal)).is_some() {
        return Ok(());
    }
    let set = ctrlc::set_handler(move || {
        let journal = current().as_ref().and_then(Weak::upgrade);
        let synced = journal.map_or(Ok(()), |journal| journal.stop());
        note("\nstopped: finished work items are kept; the same command continues the run");
        if let Err(error) = synced {
            note(format_args!("error: {error}"));
        }
        std::process::exit(130);
    });
    set.map_err(|error| Error::io("signals", "listen", std::io::Error::other(error)))
}
