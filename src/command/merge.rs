//! `bubbletouch merge`: the shards of a study put together.

use super::listener::Listener;
use super::memory_args::MemoryArgs;
use super::output::{output_folder, packings_beside};
use super::run::{FinishedStudy, failures, identity, results_folder, seconds_since};
use super::study_args::StudyArgs;
use bubbletouch::study::journal::{Identity, JOURNAL_FILE, Journal};
use bubbletouch::study::{Manner, Part, n_left, run_with};
use bubbletouch::{Error, Result};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Where the shards were told to write [default: results/ and the study's name]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// More folders with journals of shards, such as those of other machines
    #[arg(long, value_name = "FOLDER")]
    from: Vec<PathBuf>,
    #[command(flatten)]
    memory: MemoryArgs,
    #[command(flatten)]
    listener: Listener,
}

pub fn merge(args: &Args) -> Result<()> {
    let started = SystemTime::now();
    let folder = results_folder(&args.study, args.out.as_deref())?;
    let loaded = args.study.load(Some(&packings_beside(&folder)))?;
    let identity = identity(&loaded);
    output_folder(&folder)?;
    let mut journal = Journal::open(&folder.join(JOURNAL_FILE), &identity)?;
    let folders = std::iter::once(&folder).chain(&args.from);
    let mut n_journals = 0;
    for folder in folders {
        for path in shard_journals(folder)? {
            take(&mut journal, &path, &identity)?;
            n_journals += 1;
        }
    }
    journal.sync()?;
    let n_left = n_left(&loaded.plan, &loaded.sweep, Part::All, &journal);
    if n_left > 0 {
        let n_all = loaded.n_evaluations();
        return Err(Error::input(
            folder.display(),
            format!("{n_left} of {n_all} cells are in none of the {n_journals} journals"),
            "the journals of all shards, each run to its end (or bubbletouch run, which does here what is left)",
        ));
    }
    let room = args.memory.room(&loaded, &folder)?;
    let manner = Manner {
        journal: &journal,
        fail_fast: false,
        retries: false,
        part: Part::All,
        storage: &room.storage,
        at_once: room.at_once,
    };
    let progress = args.listener.progress();
    let touched = loaded.touched.as_ref();
    let outcome = run_with(
        &loaded.plan,
        &loaded.sweep,
        touched,
        progress.as_ref(),
        manner,
    )?;
    let finished = FinishedStudy {
        args: &args.study,
        folder: &folder,
        loaded: &loaded,
        identity: &identity,
        outcome: &outcome,
        started,
        n_before: loaded.n_evaluations(),
    };
    progress.stage("report", 1);
    finished.write()?;
    progress.advance(1);
    progress.finish(&format!(
        "{n_journals} shards, {:.1} s",
        seconds_since(started)
    ));
    finished.tell(args.listener);
    failures(&outcome, &folder)
}

/// Journals of shards in a folder, by name.
fn shard_journals(folder: &Path) -> Result<Vec<PathBuf>> {
    let failed = |e| Error::io(folder, "read", e);
    let (stem, ending) = JOURNAL_FILE.split_once('.').unwrap_or((JOURNAL_FILE, ""));
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let is_shard = name.starts_with(&format!("{stem}.")) && name.contains("-of-");
        if is_shard && name.ends_with(ending) {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

fn take(journal: &mut Journal, path: &Path, identity: &Identity) -> Result<()> {
    let Some((begun, shard)) = Journal::read(path)? else {
        return Ok(());
    };
    begun.check_same(identity, &path.display().to_string())?;
    journal.take_from(shard)
}
