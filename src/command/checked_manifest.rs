//! Whether the files of a folder are those that its run wrote.

use bubbletouch::report::csv_tables::sha256_of;
use bubbletouch::study::provenance::Manifest;
use bubbletouch::{Error, Result};
use std::path::Path;

/// The manifest of a folder, whose study and tables are as it says; none if there is no manifest.
pub fn checked_manifest(folder: &Path) -> Result<Option<Manifest>> {
    let Some(manifest) = Manifest::read(folder)? else {
        return Ok(None);
    };
    let study = [("study.toml", &manifest.study_sha256)];
    let tables = manifest.tables_sha256.iter().chain(&manifest.times_sha256);
    let tables = tables.map(|(name, hash)| (name.as_str(), hash));
    for (name, hash) in study.into_iter().chain(tables) {
        check(&folder.join(name), hash)?;
    }
    Ok(Some(manifest))
}

fn check(path: &Path, hash: &str) -> Result<()> {
    let given = match path.exists() {
        true if sha256_of(path)? == *hash => return Ok(()),
        true => "was changed after its run",
        false => "is missing",
    };
    let allowed = "the file that manifest.json names by its SHA-256 (bubbletouch run writes it)";
    Err(Error::input(path.display(), given, allowed))
}
