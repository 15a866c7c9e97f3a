//! The folder of a study of a whole body, and its summary.

use crate::error::Result;
use crate::report::folder::Folder;
use crate::study::whole_body::BodyOutcome;
use crate::study::whole_body::table::WholeBodyTables;
use std::path::{Path, PathBuf};

/// What a study of a whole body says of itself, beside its tables.
#[derive(Clone, Debug, Default)]
pub struct WholeBodyAbout {
    /// The study's name.
    pub name: String,
    /// What it asks.
    pub question: String,
    /// What was expected before it ran; may be empty.
    pub expected: String,
    /// Seconds from start to end.
    pub wall_s: f64,
    /// The command that makes the folder again.
    pub command: String,
    /// Program and version: `bubbletouch 0.1.0`.
    pub program: String,
}

/// File names of the tables, in the order in which they are written.
pub const WHOLE_BODY_FILES: [&str; 5] = [
    "bars.csv",
    "whole_body.csv",
    "recognition.csv",
    "sensed.csv",
    "timing.csv",
];

/// Writes tables, charts, pictures and the page into `dir` (created if missing); returns the paths, tables first.
///
/// Everything is drawn before the first file is written, and each file is whole or not there.
pub fn write_whole_body(
    dir: &Path,
    outcome: &BodyOutcome,
    _about: &WholeBodyAbout,
) -> Result<Vec<PathBuf>> {
    let tables = &outcome.tables;
    let mut folder = Folder::new(dir);
    let [bars, cases, recognition, sensed, timing] = WHOLE_BODY_FILES;
    folder.add_table(bars, &tables.bars)?;
    folder.add_table(cases, &tables.cases)?;
    folder.add_table(recognition, &tables.recognition)?;
    folder.add_table(sensed, &tables.sensed)?;
    folder.add_table(timing, &tables.timing)?;
    folder.write()
}

/// The bars.
pub fn whole_body_summary(_tables: &WholeBodyTables, _width: usize) -> String {
    String::new()
}
