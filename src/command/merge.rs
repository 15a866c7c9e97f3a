//! `bubbletouch merge`: the shards of a study put together.

use super::any_study::{end, ended, load_study};
use super::listener::Listener;
use super::memory_args::MemoryArgs;
use super::output::output_folder;
use super::run::results_folder;
use super::study_args::StudyArgs;
use bubbletouch::study::journal::{Identity, JOURNAL_FILE, Journal};
use bubbletouch::study::pieces::{Part, PieceManner};
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
    let study = load_study(args.study.clone(), &folder, args.memory.bytes()?)?;
    let identity = study.identity();
    output_folder(&folder)?;
    let mut journal = Journal::open(&folder.join(JOURNAL_FILE), identity)?;
    let folders = std::iter::once(&folder).chain(&args.from);
    let mut n_journals = 0;
    for folder in folders {
        for path in shard_journals(folder)? {
            take(&mut journal, &path, identity)?;
            n_journals += 1;
        }
    }
    journal.sync()?;
    let (n_all, n_left) = (study.n_all(), study.n_left(Part::All, &journal));
    if n_left > 0 {
        return Err(Error::input(
            folder.display(),
            format!("{n_left} of {n_all} work items are in none of the {n_journals} journals"),
            "the journals of all shards, each run to its end (or bubbletouch run, which does here what is left)",
        ));
    }
    let progress = args.listener.progress();
    let manner = PieceManner {
        journal: &journal,
        fail_fast: false,
        retries: false,
        part: Part::All,
        progress: progress.as_ref(),
    };
    let outcome = study.run(&manner)?;
    let times = (started, n_all);
    let ended = ended(&args.study, &folder, times, progress.as_ref())?;
    let what = format!("{n_journals} shards, ");
    end(study.as_ref(), &outcome, &ended, (args.listener, &what))
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
