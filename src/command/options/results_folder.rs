//! Result folder: checks that its files are those of its run, and reads the study to which they belong.

use crate::command::terminal::packings_beside;
use bubbletouch::kinds::{self, AnyStudy, Source};
use bubbletouch::study::provenance::{Manifest, SOURCE};
use bubbletouch::study::{file_content, is_built_in};
use bubbletouch::{Error, Result};
use bubbletouch_sim::text::note::note;
use std::collections::BTreeSet;
use std::path::Path;

/// Checks the files of a result folder other than tables: charts, pictures and the page. Returns the number of files that are missing: they are drawn from the
/// tables again.
pub fn check_page(folder: &Path, manifest: &Manifest) -> Result<usize> {
    let files = manifest.files_sha256.iter().flatten();
    let files = files.map(|(name, hash)| (folder.join(name), hash));
    let (there, missing): (Vec<_>, Vec<_>) = files.partition(|(path, _)| path.exists());
    there
        .into_iter()
        .try_for_each(|(path, hash)| check(&path, hash))?;
    Ok(missing.len())
}

/// Reads the manifest of a folder and checks that the study and the tables agree with it; returns `None` without a manifest.
pub fn checked_manifest(folder: &Path) -> Result<Option<Manifest>> {
    let Some(manifest) = Manifest::read(folder)? else {
        return Ok(None);
    };
    check(&folder.join("study.toml"), &manifest.study_sha256)?;
    for (name, hash) in manifest.tables_sha256.iter().chain(&manifest.times_sha256) {
        check(&folder.join(name), hash)?;
    }
    Ok(Some(manifest))
}

fn check(path: &Path, hash: &str) -> Result<()> {
    let given = match path.exists() {
        true if file_content(path)? == *hash => return Ok(()),
        true => "was changed after its run",
        false => "is missing",
    };
    let allowed = "the file that manifest.json names by its SHA-256 (bubbletouch run writes it)";
    Err(Error::input(path.display(), given, allowed))
}

/// Loads the study of a result folder, with a limit of its memory in bytes, and checks that its objects are those of the run. Built-in objects of another version
/// that differ are named in a note. Without a manifest, paths in it are relative to the folder.
pub fn load_study(
    folder: &Path,
    manifest: Option<&Manifest>,
    memory: Option<u64>,
) -> Result<Box<dyn AnyStudy>> {
    let study = kinds::load(&Source {
        folder: manifest.map_or(folder, |of| &of.paths_from).to_owned(),
        packings: Some(packings_beside(folder)),
        results: folder.to_owned(),
        memory,
        ..Source::of_results(folder)?
    })?;
    let objects = &study.identity().objects;
    let of_run = manifest.map_or(objects, |of| &of.objects_sha256);
    let is_same_version = manifest.is_none_or(|of| of.source == SOURCE);
    let mut differing = Vec::new();
    let names: BTreeSet<&String> = of_run.keys().chain(objects.keys()).collect();
    for name in names {
        let given = match (of_run.get(name), objects.get(name)) {
            (before, now) if before == now => continue,
            // A built-in object belongs to the version of the program.
            (_, Some(now)) if !is_same_version && is_built_in(name, now)? => {
                differing.push(&name[..]);
                continue;
            }
            (None, _) => "is not in the run",
            (_, None) => "is missing",
            _ => "was changed after the run",
        };
        let allowed = "the object that manifest.json names by its SHA-256";
        let place = format!("{}: object {name}", folder.display());
        return Err(Error::input(place, given, allowed));
    }
    if !differing.is_empty() {
        note(format_args!(
            "{}: built-in objects that this version describes otherwise than the run: {}",
            folder.display(),
            differing.join(", ")
        ));
    }
    Ok(study)
}
