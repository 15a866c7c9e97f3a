//! `bubbletouch report`: the page of a folder of results of recognition again, from its tables.

use super::about_study::{add_manifest, add_touches, page_of_spec};
use super::checked_manifest::checked_manifest;
use super::output::packings_beside;
use super::streams::{note, say};
use super::study_args::StudyArgs;
use bubbletouch::report::csv_tables::{LIMITS_FILE, read_rows, read_tables};
use bubbletouch::report::page::ReportPage;
use bubbletouch::report::results::write_page;
use bubbletouch::study::StudyKind;
use bubbletouch::study::provenance::{MANIFEST_FILE, Manifest};
use bubbletouch::{Error, Result};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub struct Args {
    /// A folder that `bubbletouch run` wrote
    results: PathBuf,
    /// Draw every static chart of a study of recognition; without it the first 24
    #[arg(long)]
    all_charts: bool,
}

pub fn report(args: &Args) -> Result<()> {
    let folder = &args.results;
    check_kind(folder)?;
    let manifest = checked_manifest(folder)?;
    if manifest.is_none() {
        note(format_args!(
            "note: whether the tables are those of a run is not known: there is no {}",
            folder.join(MANIFEST_FILE).display()
        ));
    }
    let tables = read_tables(folder)?;
    let mut page = about(folder, manifest)?;
    page.all_charts = args.all_charts;
    write_page(folder, &tables, &page)?;
    say(format_args!(
        "Wrote {}",
        folder.join("report.html").display()
    ))
}

/// An error if the folder is of a study that does not recognise.
fn check_kind(folder: &Path) -> Result<()> {
    let path = folder.join("study.toml");
    let text = std::fs::read_to_string(&path).unwrap_or_default();
    match StudyKind::of(&text) {
        StudyKind::Recognition => Ok(()),
        kind => Err(Error::input(
            path.display(),
            kind.words(),
            format!(
                "{} (of any other, bubbletouch run draws again what is finished)",
                StudyKind::Recognition.words()
            ),
        )),
    }
}

/// What the folder says of itself: its study, its manifest, and the touches of its study, made again.
fn about(folder: &Path, manifest: Option<Manifest>) -> Result<ReportPage> {
    let study = StudyArgs {
        study: folder.join("study.toml"),
        objects: None,
        seed: None,
        threads: None,
        paths_from: None,
    };
    let name = match &manifest {
        Some(manifest) if !manifest.study.is_empty() => manifest.study.clone(),
        _ => folder_name(folder)?,
    };
    let spec = study.plan()?.spec;
    let mut page = page_of_spec(&spec, &name);
    let packings = packings_beside(folder);
    let loaded = study.load(Some(&packings));
    if let Err(error) = loaded.and_then(|loaded| add_touches(&mut page, &loaded)) {
        note(format_args!(
            "note: the page has no sample touches: {error}"
        ));
    }
    let limits = folder.join(LIMITS_FILE);
    match limits.exists() {
        true => page.limits = read_rows(&limits)?,
        false => note(format_args!(
            "note: the page does not say which limits were reached: there is no {}",
            limits.display()
        )),
    }
    if let Some(manifest) = manifest {
        add_manifest(&mut page, manifest);
    }
    if page.command.is_empty() {
        page.command = format!("bubbletouch run {}", study.study.display());
    }
    Ok(page)
}

fn folder_name(folder: &Path) -> Result<String> {
    let whole = folder
        .canonicalize()
        .map_err(|e| Error::io(folder, "read", e))?;
    let name = whole.file_name().unwrap_or_default();
    Ok(name.to_string_lossy().into_owned())
}
