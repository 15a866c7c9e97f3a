//! Output of the command: results on standard output, notes on standard error. Nothing else here writes to either.
//!
//! A reader that closes its pipe has read enough: what is said after that is dropped, the work goes on to its end, and the exit code is
//! that of the work. A standard output that takes no more for another reason (a full disk) is an error. Notes are never one.

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
