//! `bubbletouch run`: runs a study file and writes its folder of results.

use crate::command::options::study_args::QUICKSTART_FILE;
use crate::command::options::study_run::{RunArgs, StudyRun};
use crate::command::terminal::{keep_journal_on_signals, output_folder, say};
use bubbletouch::kinds::AnyStudy;
use bubbletouch::study::Shard;
use bubbletouch::study::journal::{JOURNAL_FILE, Journal, rename_old_results};
use bubbletouch::study::provenance::Manifest;
use bubbletouch::study::work_items::{Part, RunOptions};
use bubbletouch::{Error, Result};
use std::path::Path;
use std::sync::Arc;

/// Run a study; write tables, charts and a report
///
/// One table of the study determines its kind. [recognition]: which object is touched. [reconstruction]: how exactly frames are reconstructed from
/// measurements. [object_detail]: how detailed models of objects must be. [whole_body]: the cost of a body with millions of taxels. [stability]: the
/// settings at which contact methods fail.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  bubbletouch run experiments/cans.toml --out results/cans")]
pub struct Args {
    #[command(flatten)]
    run: RunArgs,
    /// Start over; rename the old folder to FOLDER.1, FOLDER.2, …
    ///
    /// Without this option, the run continues with the work items that an earlier run of this study has not finished.
    #[arg(long, help_heading = "Run")]
    fresh: bool,
    /// Stop at the first work item that fails
    ///
    /// Without this option, failures.csv lists the failed work items and the run continues.
    #[arg(long, help_heading = "Run")]
    fail_fast: bool,
    /// Run part I of N; bubbletouch merge joins the parts
    #[arg(
        long,
        value_name = "I/N",
        conflicts_with = "chart_format",
        help_heading = "Run"
    )]
    shard: Option<Shard>,
    /// Run anew, unless the previous run was interrupted
    #[arg(long, hide = true)]
    demonstration: bool,
}

impl Args {
    /// Returns the work items that this run computes.
    fn part(&self) -> Part<'static> {
        self.shard.map_or(Part::All, Part::Shard)
    }
}

pub fn run(args: &Args) -> Result<()> {
    if args.demonstration {
        let folder = args.run.results.folder()?;
        if Manifest::read(&folder)?.is_some_and(|earlier| !earlier.is_of_this_commit()) {
            return say(format_args!(
                "{} has results of another commit, which are kept. `bubbletouch run {QUICKSTART_FILE} --fresh` sets them aside and runs the study.",
                folder.display()
            ));
        }
    }
    let run = StudyRun::begin(&args.run, args.fresh)?;
    let (study, progress) = (run.study.as_ref(), run.progress.as_ref());
    if let Some(mixed) = args.run.results.study.mixed_touches()? {
        progress.finish(&mixed);
    }
    let journal = open_journal(args, &run)?;
    let n_all = study.n_all();
    let n_before = n_all - study.n_pending(Part::All, &journal);
    if n_before > 0 {
        let going_on = format!("going on: {n_before} of {n_all} work items were finished before");
        progress.finish(&going_on);
    }
    let outcome = study.run(&RunOptions {
        journal: &journal,
        fail_fast: args.fail_fast,
        retries: true,
        part: args.part(),
        progress,
    })?;
    journal.sync()?;
    let Some(shard) = args.shard else {
        return run.end(&outcome, n_before, "");
    };
    progress.finish(&format!("{:.1} s", run.elapsed_s()));
    let results = &args.run.results;
    let merge = results.study.command("merge", results.out.as_deref());
    progress.finish(&format!(
        "shard {shard} is done; when all are, put them together: {merge}"
    ));
    run.failures(&outcome)
}

/// Opens the journal of the run's folder with exclusive access, and installs the signal handlers.
fn open_journal(args: &Args, run: &StudyRun) -> Result<Arc<Journal>> {
    let (study, folder) = (run.study.as_ref(), &run.folder);
    let path = folder.join(match args.shard {
        Some(shard) => shard.file_name(JOURNAL_FILE),
        None => JOURNAL_FILE.to_owned(),
    });
    let finished = match args.fresh {
        true => Journal::default(),
        false => Journal::read_records(&path)?,
    };
    study.check(args.part(), &finished)?;
    if args.fresh
        && let Some(old) = rename_old_results(folder)?
    {
        let remark = format!("the old results are in {}", old.display());
        run.progress.finish(&remark);
    }
    output_folder(folder)?;
    if args.demonstration && path.exists() && !is_interrupted(study, &path) {
        std::fs::remove_file(&path).map_err(|e| Error::io(&path, "remove", e))?;
    }
    let journal = Arc::new(Journal::open(&path, study.identity())?);
    keep_journal_on_signals(&journal)?;
    Ok(journal)
}

/// Returns whether a journal belongs to this study and some of its work items are pending.
fn is_interrupted(study: &dyn AnyStudy, journal: &Path) -> bool {
    let Ok(Some((begun, journal))) = Journal::read(journal) else {
        return false;
    };
    let differences = study.identity().differences((&begun, journal.records()));
    differences.is_empty() && study.n_pending(Part::All, &journal) > 0
}
