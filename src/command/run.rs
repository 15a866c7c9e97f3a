//! `bubbletouch run`: a study from its file to its folder of results.

use super::any_study::{end, ended, failures, load_study, seconds_since};
use super::command_line::merge_line;
use super::listener::Listener;
use super::memory_args::MemoryArgs;
use super::study_args::StudyArgs;
use super::study_folder::{Start, StudyFolder};
use bubbletouch::study::Shard;
use bubbletouch::study::pieces::{Part, PieceManner};
use bubbletouch::{Error, Result};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Where to write tables, charts and report.html [default: results/ and the study's name]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Start over; what stands in the folder is kept beside it, as FOLDER.1, FOLDER.2 ... Without it, a run goes on from
    /// what an earlier run of the same study has finished
    #[arg(long)]
    fresh: bool,
    /// Stop at the first work item that fails, rather than record it in failures.csv and go on
    #[arg(long)]
    fail_fast: bool,
    /// Do only part I of N of the work, for one of N processes or machines; `bubbletouch merge` puts them together
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// End as if killed when so many work items are kept: to try what is left of a run
    #[arg(long, value_name = "N", hide = true)]
    abort_after: Option<usize>,
    #[command(flatten)]
    memory: MemoryArgs,
    #[command(flatten)]
    listener: Listener,
    /// A demonstration runs anew unless it was interrupted.
    #[arg(skip)]
    is_demonstration: bool,
}

impl Args {
    /// What a bare `bubbletouch` runs.
    pub fn quickstart() -> Self {
        Self {
            study: StudyArgs::quickstart(),
            out: None,
            fresh: false,
            fail_fast: false,
            shard: None,
            abort_after: None,
            memory: MemoryArgs::default(),
            listener: Listener::default(),
            is_demonstration: true,
        }
    }

    fn start(&self) -> Start {
        match (self.fresh, self.is_demonstration) {
            (true, _) => Start::Fresh,
            (false, true) => Start::Demonstration,
            (false, false) => Start::GoOn,
        }
    }
}

pub fn run(args: &Args) -> Result<()> {
    let started = SystemTime::now();
    let folder = results_folder(&args.study, args.out.as_deref())?;
    let study = load_study(args.study.clone(), &folder, args.memory.bytes()?)?;
    if let Some(mixed) = args.study.mixed_touches()? {
        args.listener.remark(&format!("note: {mixed}"));
    }
    let how = (args.start(), args.shard);
    let kept = StudyFolder::open(&folder, study.identity(), how, args.listener)?;
    let n_all = study.n_all();
    let n_before = n_all - study.n_left(Part::All, &kept.journal);
    if n_before > 0 {
        let going_on = format!("going on: {n_before} of {n_all} work items were finished before");
        args.listener.remark(&going_on);
    }
    kept.journal.abort_after(args.abort_after.unwrap_or(0));
    let progress = args.listener.progress();
    let manner = PieceManner {
        journal: &kept.journal,
        fail_fast: args.fail_fast,
        retries: true,
        part: args.shard.map_or(Part::All, Part::Shard),
        progress: progress.as_ref(),
    };
    let outcome = study.run(&manner)?;
    kept.journal.sync()?;
    if let Some(shard) = args.shard {
        progress.finish(&format!("{:.1} s", seconds_since(started)));
        let merge = merge_line(&args.study, args.out.as_deref());
        args.listener.remark(&format!(
            "shard {shard} is done; when all are, put them together: {merge}"
        ));
        return failures(study.as_ref(), &outcome, &folder);
    }
    let times = (started, n_before);
    let ended = ended(&args.study, &folder, times, progress.as_ref())?;
    let result = end(study.as_ref(), &outcome, &ended, (args.listener, ""));
    let is_written = matches!(result, Ok(()) | Err(Error::WorkItems { .. }));
    if args.is_demonstration && is_written {
        kept.forget()?;
    }
    result
}

/// Where a study's results go.
pub fn results_folder(study: &StudyArgs, out: Option<&Path>) -> Result<PathBuf> {
    match out {
        Some(folder) => Ok(folder.to_owned()),
        None => Ok(Path::new("results").join(study.name()?)),
    }
}
