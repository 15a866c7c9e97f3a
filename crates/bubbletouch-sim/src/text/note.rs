//! Notes on standard error, about inputs that are not interpreted as written and about slow operations.

use std::fmt::Display;
use std::io::Write;

/// Writes the line `note: …` to standard error. A closed standard error is ignored.
pub fn note(text: impl Display) {
    let _ = writeln!(std::io::stderr(), "note: {text}");
}
