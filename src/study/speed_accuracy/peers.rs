//! What other programs take for the same press, as they left it in a file.

use super::table::PeerRow;
use crate::error::{Error, Result};
use std::path::Path;

/// The rows of a file; none where there is no file. The error names the file and the line.
pub(super) fn read_peers(path: &Path) -> Result<Vec<PeerRow>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let failed = |error: csv::Error| {
        let line = error.position().map(|at| format!(", line {}", at.line()));
        let place = format!("{}{}", path.display(), line.unwrap_or_default());
        let allowed = "a table as benches/peers/contact.py writes it";
        Error::input(place, format!("cannot be read ({error})"), allowed)
    };
    let mut reader = csv::Reader::from_path(path).map_err(failed)?;
    reader
        .deserialize()
        .map(|row| row.map_err(failed))
        .collect()
}
