//! `bubbletouch verify`: checks that a result folder can be reproduced.

use crate::command::options::results_folder::{check_page, checked_manifest, load_study};
use crate::command::options::study_args::{MemoryLimit, set_threads};
use crate::command::program;
use crate::command::terminal::say;
use bubbletouch::report::progress::to_stderr;
use bubbletouch::shell_line::shell_line;
use bubbletouch::study::provenance::{MANIFEST_FILE, SOURCE};
use bubbletouch::{Error, Result};
use bubbletouch_sim::text::spelling::counted;
use std::path::PathBuf;

/// Check a results folder and re-run some of its work items
///
/// Every file is compared with its SHA-256 in manifest.json. New results are compared with the stored ones byte by byte.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  bubbletouch verify results/quickstart --work-items 10")]
pub struct Args {
    /// Results folder that bubbletouch run wrote
    results: PathBuf,
    /// Re-run N randomly drawn work items
    #[arg(
        long,
        aliases = ["configurations", "cells"],
        value_name = "N",
        default_value_t = 5,
        help_heading = "Run"
    )]
    work_items: usize,
    /// Set the seed of the random draw
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Run")]
    draw: u64,
    /// Use N threads [default: all cores]
    #[arg(long, value_name = "N", help_heading = "Run")]
    threads: Option<usize>,
    #[command(flatten)]
    memory: MemoryLimit,
}

pub fn verify(args: &Args) -> Result<()> {
    let folder = &args.results;
    let manifest = checked_manifest(folder)?.ok_or_else(|| {
        let path = folder.join(MANIFEST_FILE);
        Error::input(path.display(), "is missing", "the manifest of a run")
    })?;
    let n_missing = check_page(folder, &manifest)?;
    if n_missing > 0 {
        let again = shell_line(&[&*program(), "report", &folder.display().to_string()]);
        say(format_args!(
            "note: missing charts, pictures or page: {}; {again} draws them",
            counted(n_missing, "file")
        ))?;
    }
    if manifest.source != SOURCE {
        say(format_args!(
            "note: the results were made by {} (commit {}), not by this version",
            manifest.program, manifest.commit
        ))?;
    }
    set_threads(args.threads)?;
    let study = load_study(folder, Some(&manifest), args.memory.bytes()?)?;
    let said = study.verify(folder, args.work_items, args.draw, to_stderr().as_ref())?;
    say(format_args!("{}: {said}", folder.display()))
}
