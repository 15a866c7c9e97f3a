//! A study's folder while a run works in it: what was finished before, and what a signal must not lose.

use super::listener::Listener;
use super::output::output_folder;
use super::streams::note;
use bubbletouch::study::Shard;
use bubbletouch::study::journal::{Identity, JOURNAL_FILE, Journal, set_aside};
use bubbletouch::{Error, Result};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How a run begins where results may stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// From what an earlier run has finished; another study's journal is refused.
    GoOn,
    /// From nothing; what stands there is renamed.
    Fresh,
    /// From what an interrupted run of the same study has finished; any other journal is dropped.
    Demonstration,
}

/// A folder whose journal is open, for this process alone.
pub struct StudyFolder {
    pub journal: Arc<Journal>,
    path: PathBuf,
}

impl StudyFolder {
    /// Opens a folder, makes it if it is missing, and sees to it that signals end the process with nothing lost.
    pub fn open(
        folder: &Path,
        identity: &Identity,
        (start, shard): (Start, Option<Shard>),
        listener: Listener,
    ) -> Result<Self> {
        if start == Start::Fresh
            && let Some(old) = set_aside(folder)?
        {
            listener.remark(&format!("the old results are in {}", old.display()));
        }
        output_folder(folder)?;
        let name = shard.map_or(JOURNAL_FILE.to_owned(), |shard| {
            shard.file_name(JOURNAL_FILE)
        });
        let path = folder.join(name);
        if start == Start::Demonstration && !is_of(&path, identity) {
            remove(&path)?;
        }
        let journal = Arc::new(Journal::open(&path, identity)?);
        end_well_on_signals(&journal)?;
        Ok(Self { journal, path })
    }

    /// Removes the journal: the next run starts from nothing.
    pub fn forget(&self) -> Result<()> {
        remove(&self.path)
    }
}

/// Whether a journal is of a study, or there is none.
fn is_of(path: &Path, identity: &Identity) -> bool {
    match Journal::read(path) {
        Ok(Some((begun, _))) => begun.differences(identity).is_empty(),
        Ok(None) => true,
        Err(_) => false,
    }
}

fn remove(journal: &Path) -> Result<()> {
    std::fs::remove_file(journal).map_err(|e| Error::io(journal, "remove", e))
}

/// On Ctrl-C, and when a scheduler ends the process: nothing is half-written, and a line says how to go on.
fn end_well_on_signals(journal: &Arc<Journal>) -> Result<()> {
    let journal = Arc::clone(journal);
    let set = ctrlc::set_handler(move || {
        let synced = journal.stop();
        let mut said =
            "\nstopped: all that is finished is kept; the same command goes on from there"
                .to_owned();
        if let Err(error) = synced {
            said += &format!("\nerror: {error}");
        }
        // Nobody may be left to read it, which must not keep the process from ending.
        note(said);
        std::process::exit(130);
    });
    set.map_err(|error| Error::io("signals", "listen", std::io::Error::other(error)))
}
