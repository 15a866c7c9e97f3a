//! A study of any kind, as the commands see it that run it, merge it, submit it and verify it.

use super::command_line::command_line;
use super::listener::Listener;
use super::output::{tell_where, terminal_width};
use super::streams::write_out;
use super::study_args::StudyArgs;
use bubbletouch::kinds::{self, AnyStudy, EndedRun, Outcome};
use bubbletouch::report::csv_tables::FAILURES_FILE;
use bubbletouch::study::progress::Progress;
use bubbletouch::{Error, Result};
use std::path::Path;
use std::time::SystemTime;

/// Reads and checks a study of any kind and loads its objects; it is to hold at most so many bytes.
pub fn load_study(
    mut args: StudyArgs,
    folder: &Path,
    memory: Option<u64>,
) -> Result<Box<dyn AnyStudy>> {
    args.memory = memory;
    args.results = folder.to_owned();
    kinds::load(&args.source()?)
}

/// Writes and tells what came of a study; an error if some of it failed.
pub fn end(
    study: &dyn AnyStudy,
    outcome: &Outcome,
    run: &EndedRun,
    (listener, what): (Listener, &str),
) -> Result<()> {
    run.progress.stage("report", 1);
    study.write(outcome, run)?;
    run.progress.advance(1);
    let elapsed_s = run.wall_s();
    run.progress.finish(&format!("{what}{elapsed_s:.1} s"));
    listener.finished(serde_json::json!({
        "event": "finished",
        "folder": run.folder,
        "work_items": study.n_all(),
        "finished_before": run.n_before,
        "failed": outcome.n_failed,
        "elapsed_s": elapsed_s,
    }))?;
    if listener.is_person() {
        write_out(study.words(outcome, terminal_width()).as_bytes())?;
        tell_where(run.folder)?;
    }
    failures(study, outcome, run.folder)
}

/// A run of a study that has ended.
pub fn ended<'a>(
    args: &StudyArgs,
    folder: &'a Path,
    (started, n_before): (SystemTime, usize),
    progress: &'a dyn Progress,
) -> Result<EndedRun<'a>> {
    Ok(EndedRun {
        name: args.name()?,
        command: command_line(args),
        paths_from: args.folder(),
        folder,
        started,
        n_before,
        progress,
    })
}

/// An error if some of a study failed.
pub fn failures(study: &dyn AnyStudy, outcome: &Outcome, folder: &Path) -> Result<()> {
    match outcome.n_failed {
        0 => Ok(()),
        n_failed => Err(Error::WorkItems {
            path: folder.join(FAILURES_FILE),
            n_failed,
            n_all: study.n_all(),
        }),
    }
}

pub fn seconds_since(started: SystemTime) -> f64 {
    started.elapsed().unwrap_or_default().as_secs_f64()
}
