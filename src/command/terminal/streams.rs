//! Output of the command: results on standard output, notes on standard error. No other module writes to these streams.
//!
//! If the reader closes the pipe, further output is discarded, the work is completed, and the exit code is the result of the work. Any other failure of
//! standard output (such as a full disk) is an error. Failures of notes are ignored.

use bubbletouch::{Error, Result};
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

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
