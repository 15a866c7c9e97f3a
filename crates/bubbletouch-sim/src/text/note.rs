//! Notes on standard error, about inputs that are not interpreted as written and about slow operations.

use std::collections::BTreeSet;
use std::fmt::Display;
use std::io::Write;
use std::sync::Mutex;

/// Notes of this process. A file that is read several times has one note.
static NOTED: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());

/// Writes the line `note: …` to standard error, unless this process has written it before. A closed standard error is ignored.
pub fn note(text: impl Display) {
    let mut noted = NOTED.lock().unwrap_or_else(|e| e.into_inner());
    let text = text.to_string();
    if !noted.contains(&text) {
        let _ = writeln!(std::io::stderr(), "note: {text}");
        noted.insert(text);
    }
}
