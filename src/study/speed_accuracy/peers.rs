//! What other programs take for the same press, as they left it in a file.

use super::table::PeerRow;
use crate::error::Result;
use crate::files::table_error;
use std::path::Path;

/// The rows of a file; none where there is no file. The error names the file and the line.
pub(super) fn read_peers(path: &Path) -> Result<Vec<PeerRow>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let failed = table_error(path, "a table as benches/peers/contact.py writes it");
    let mut reader = csv::Reader::from_path(path).map_err(&failed)?;
    reader
        .deserialize()
        .map(|row| row.map_err(&failed))
        .collect()
}
