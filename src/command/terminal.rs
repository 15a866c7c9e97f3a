//! Output of the command, its folders and files, and handling of signals.
//!
//! Results are printed on standard output, notes on standard error. No other module writes to these streams. If the reader closes the pipe, further output is
//! discarded, the work is completed, and the exit code is the result of the work. Any other failure of standard output (such as a full disk) is an error.
//! Failures of notes are ignored. On Ctrl-C and termination signals, files stay complete, and a message explains how to resume the run.

use bubbletouch::files::check_single_output;
use bubbletouch::study::journal::Journal;
use bubbletouch::{Error, Result};
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// Prints a line on standard output.
pub fn say(line: impl Display) -> Result<()> {
    write_out(format!("{line}\n").as_bytes())
}

/// Writes bytes to standard output without changes.
pub fn write_out(content: &[u8]) -> Result<()> {
    let mut out = io::stdout().lock();
    written(out.write_all(content).and_then(|()| out.flush()))
}

/// Converts the result of a write to standard output; a closed pipe is not an error.
pub fn written(result: io::Result<()>) -> Result<()> {
    match result {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Error::io("standard output", "write", error))
        }
        _ => Ok(()),
    }
}

/// Prints a line on standard error; errors of printing are ignored.
pub fn note(line: impl Display) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Creates an output folder; returns an error if a file with this name exists.
pub fn output_folder(folder: &Path) -> Result<()> {
    if folder.exists() && !folder.is_dir() {
        let allowed = "a folder, or a path where one can be made";
        return Err(Error::input(folder.display(), "a file", allowed));
    }
    std::fs::create_dir_all(folder).map_err(|e| match e.kind() {
        // A parent folder in the path is a file.
        ErrorKind::NotADirectory | ErrorKind::AlreadyExists => {
            let allowed = "a path where a folder can be made";
            Error::input(folder.display(), "below a file", allowed)
        }
        _ => Error::io(folder, "create folder", e),
    })
}

/// Returns an error if a file name has another ending than required, or if the file belongs to a folder of results or of data.
pub fn check_ending(path: Option<&Path>, ending: &str) -> Result<()> {
    path.map_or(Ok(()), check_single_output)?;
    let has_another = |path: &&Path| path.extension().is_none_or(|given| given != ending);
    let Some(path) = path.filter(has_another) else {
        return Ok(());
    };
    let given = format!("not a .{ending} file");
    let allowed = format!("a name that ends in .{ending}");
    Err(Error::input(path.display(), given, allowed))
}

/// Returns the folder that stores packed meshes for later runs, next to a folder of results.
pub fn packings_beside(folder: &Path) -> PathBuf {
    folder.parent().unwrap_or(Path::new("")).join("packings")
}

/// Returns the width of the terminal in characters, or a default width without a terminal.
pub fn terminal_width() -> usize {
    let terminal = console::Term::stdout();
    match terminal.size_checked() {
        Some((_, columns)) if terminal.is_term() => usize::from(columns),
        _ => 100,
    }
}

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
    set.map_err(|error| Error::io("signals", "listen", io::Error::other(error)))
}
