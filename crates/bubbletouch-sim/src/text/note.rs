//! Notes on standard error: what was read in another way than it is written, and what takes long.

use std::fmt::Display;
use std::io::Write;

/// Writes the line `note: …` on standard error. A closed standard error changes nothing.
pub fn note(text: impl Display) {
    let _ = writeln!(std::io::stderr(), "note: {text}");
}
