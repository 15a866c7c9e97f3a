//! `bubbletouch merge`: combines the results of the shards of a study.

use crate::command::options::study_run::{RunArgs, StudyRun};
use crate::command::terminal::output_folder;
use bubbletouch::study::journal::{JOURNAL_FILE, Journal};
use bubbletouch::study::work_items::{Part, RunOptions};
use bubbletouch::{Error, Result};
use std::path::PathBuf;

/// Merge the shards of a study; write tables, charts and a report
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch merge study.toml --out results/study --from from_machine_1"
)]
pub struct Args {
    #[command(flatten)]
    run: RunArgs,
    /// Read shard journals from this folder, too; repeatable
    #[arg(long, value_name = "FOLDER", help_heading = "Input")]
    from: Vec<PathBuf>,
}

pub fn merge(args: &Args) -> Result<()> {
    let run = StudyRun::begin(&args.run, false)?;
    let (study, folder) = (run.study.as_ref(), &run.folder);
    let identity = study.identity();
    let path = folder.join(JOURNAL_FILE);
    let mut found = Journal::read_records(&path)?;
    let own = std::iter::once(folder).filter(|folder| folder.exists());
    let folders = own.chain(&args.from).map(PathBuf::as_path);
    let n_journals = found.take_from_shards(identity, folders)?;
    let (n_all, n_pending) = (study.n_all(), study.n_pending(Part::All, &found));
    let is_complete = || match n_pending {
        0 => study.check(Part::All, &found),
        _ => Err(Error::input(
            folder.display(),
            format!("{n_pending} of {n_all} work items are in none of the {n_journals} journals"),
            "the journals of all shards, each run to its end (or bubbletouch run, which computes the missing work items)",
        )),
    };
    let complete = is_complete();
    // Without a single result, nothing is written.
    if n_pending == n_all {
        return complete;
    }
    output_folder(folder)?;
    let mut journal = Journal::open(&path, identity)?;
    journal.take_from(found)?;
    journal.sync()?;
    complete?;
    let outcome = study.run(&RunOptions {
        journal: &journal,
        fail_fast: false,
        // Items that failed in every shard run again.
        retries: true,
        part: Part::All,
        progress: run.progress.as_ref(),
    })?;
    run.end(&outcome, n_all, &format!("{n_journals} shards, "))
}
