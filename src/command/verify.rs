//! `bubbletouch verify`: whether a folder of results comes out again.

use super::any_study::load_study;
use super::checked_manifest::checked_manifest;
use super::memory_args::MemoryArgs;
use super::streams::say;
use super::study_args::StudyArgs;
use bubbletouch::report::progress::to_stderr;
use bubbletouch::study::provenance::{MANIFEST_FILE, Manifest, SOURCE};
use bubbletouch::{Error, Result};
use std::path::PathBuf;

#[derive(clap::Args)]
pub struct Args {
    /// A folder that `bubbletouch run` wrote
    results: PathBuf,
    /// How many work items to run again, drawn at random
    #[arg(long, value_name = "N", default_value_t = 5)]
    cells: usize,
    /// Which of them are drawn
    #[arg(long, value_name = "N", default_value_t = 0)]
    draw: u64,
    /// Threads; all cores when left out
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    #[command(flatten)]
    memory: MemoryArgs,
}

pub fn verify(args: &Args) -> Result<()> {
    let folder = &args.results;
    let manifest = check_manifest(args)?;
    let study = StudyArgs {
        threads: args.threads,
        ..StudyArgs::of_results(folder, Some(manifest.paths_from))
    };
    let study = load_study(study, folder, args.memory.bytes()?)?;
    let progress = to_stderr();
    let said = study.verify(folder, args.cells, args.draw, progress.as_ref())?;
    say(format_args!("{}: {said}", folder.display()))
}

/// An error if a file is not what the manifest says; a note if the program is another.
fn check_manifest(args: &Args) -> Result<Manifest> {
    let manifest = checked_manifest(&args.results)?.ok_or_else(|| {
        let path = args.results.join(MANIFEST_FILE);
        Error::input(path.display(), "is missing", "the manifest of a run")
    })?;
    if manifest.source != SOURCE {
        say(format_args!(
            "note: the results were made by {} (commit {}), not by this version",
            manifest.program, manifest.commit
        ))?;
    }
    Ok(manifest)
}
