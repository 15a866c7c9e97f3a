//! Files that are whole or not there: written beside their name, then renamed.

use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

/// Writes a file through `fill`; on any failure nothing is left under `path` that was not there before.
pub fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
) -> Result<()> {
    match fs::metadata(path) {
        Ok(meta) if meta.is_dir() => {
            return Err(Error::input(
                path.display(),
                "is a folder",
                "a file to write",
            ));
        }
        // A device or a pipe cannot be replaced by a rename: write to it as it stands.
        Ok(meta) if !meta.is_file() => {
            let written = File::create(path).and_then(|file| {
                let mut writer = BufWriter::new(file);
                fill(&mut writer)?;
                writer.flush()
            });
            return written.map_err(|e| Error::io(path, "write", e));
        }
        _ => {}
    }
    let name = path.file_name().ok_or_else(|| {
        Error::input(
            path.display(),
            "not a file name",
            "a path that ends in a file name",
        )
    })?;
    let mut partial_name = name.to_owned();
    partial_name.push(format!(".{}.partial", std::process::id()));
    let partial = path.with_file_name(partial_name);
    let written = File::create(&partial).and_then(|file| {
        let mut writer = BufWriter::new(file);
        fill(&mut writer)?;
        writer.into_inner().map_err(|e| e.into_error())?.sync_all()
    });
    let renamed = written
        .map_err(|e| Error::io(path, "write", e))
        .and_then(|()| fs::rename(&partial, path).map_err(|e| Error::io(path, "rename", e)));
    if renamed.is_err() {
        // The partial file is ours alone; that it cannot be removed changes nothing in what is reported.
        let _ = fs::remove_file(&partial);
    }
    renamed
}

/// Writes bytes as a whole file.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<()> {
    write_whole(path, |writer| writer.write_all(bytes))
}
