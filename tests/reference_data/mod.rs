//! Folders of reference data, which are not part of the project.

use std::io::Write;
use std::path::PathBuf;

/// The folder that an environment variable names; without one the test that asks says aloud that it skips.
pub fn folder(variable: &str) -> Option<PathBuf> {
    let folder = std::env::var_os(variable).map(PathBuf::from);
    if folder.is_none() {
        // Past the harness, which keeps what is printed by tests that pass.
        writeln!(std::io::stderr(), "SKIPPED: {variable} names no folder")
            .expect("standard error takes a line");
    }
    folder
}
