//! `bubbletouch report`: the page of a folder of results of recognition again, from its tables.

use super::any_study::load_study;
use super::checked_manifest::checked_manifest;
use super::streams::{note, say};
use super::study_args::StudyArgs;
use bubbletouch::report::page::StudyAbout;
use bubbletouch::study::provenance::MANIFEST_FILE;
use bubbletouch::{Error, Result};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub struct Args {
    /// A folder that `bubbletouch run` wrote
    results: PathBuf,
    /// Draw every chart as a file; without it the first 24
    #[arg(long)]
    all_charts: bool,
}

pub fn report(args: &Args) -> Result<()> {
    let folder = &args.results;
    let manifest = checked_manifest(folder)?;
    if manifest.is_none() {
        note(format_args!(
            "note: whether the tables are those of a run is not known: there is no {}",
            folder.join(MANIFEST_FILE).display()
        ));
    }
    let paths_from = manifest
        .as_ref()
        .map(|manifest| manifest.paths_from.clone());
    let study = StudyArgs::of_results(folder, paths_from);
    let name = match &manifest {
        Some(manifest) if !manifest.study.is_empty() => manifest.study.clone(),
        _ => folder_name(folder)?,
    };
    let command = match &manifest {
        Some(manifest) => manifest.command.clone(),
        None => format!("bubbletouch run {}", study.study.display()),
    };
    let about = StudyAbout {
        name,
        command,
        manifest,
        all_charts: args.all_charts,
        ..StudyAbout::default()
    };
    load_study(study, folder, None)?.report(folder, about)?;
    say(format_args!(
        "Wrote {}",
        folder.join("report.html").display()
    ))
}

fn folder_name(folder: &Path) -> Result<String> {
    let whole = folder
        .canonicalize()
        .map_err(|e| Error::io(folder, "read", e))?;
    let name = whole.file_name().unwrap_or_default();
    Ok(name.to_string_lossy().into_owned())
}
