//! `bubbletouch slurm`: the shards of a study as an array of jobs, and their merge after them.

use super::any_study::load_study;
use super::output::output_folder;
use super::run::results_folder;
use super::slurm_jobs::{Job, queued_shards, submit};
use super::streams::say;
use super::study_args::StudyArgs;
use bubbletouch::kinds::AnyStudy;
use bubbletouch::study::Shard;
use bubbletouch::study::journal::{JOURNAL_FILE, Journal};
use bubbletouch::study::pieces::Part;
use bubbletouch::{Error, Result};
use std::path::{Path, PathBuf};

/// Jobs of an array, at most: what Slurm can be set to.
const MOST_JOBS: usize = 4_000_000;

#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Where to write tables, charts and report.html [default: results/ and the study's name]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Into how many jobs the study is divided
    #[arg(long, value_name = "N")]
    array: usize,
    /// Time limit of a job, as sbatch takes it: 2:00:00
    #[arg(long, value_name = "TIME")]
    time: Option<String>,
    /// Memory of a job, as sbatch takes it: 4G
    #[arg(long, value_name = "SIZE")]
    mem: Option<String>,
    /// Partition of the cluster
    #[arg(long, value_name = "NAME")]
    partition: Option<String>,
}

pub fn slurm(args: &Args) -> Result<()> {
    if !(1..=MOST_JOBS).contains(&args.array) {
        let allowed = format!("1 to {MOST_JOBS} jobs");
        return Err(Error::input("--array", args.array, allowed));
    }
    let folder = results_folder(&args.study, args.out.as_deref())?;
    let study = load_study(args.study.clone(), &folder, None)?;
    output_folder(&folder)?;
    let jobs = Jobs::new(args, &folder)?;
    let queued = queued_shards(&jobs.name("shards"))?;
    let mut missing = Vec::new();
    for shard in Shard::all(args.array) {
        let is_queued = queued.contains(&shard.index());
        if !is_queued && !is_done(study.as_ref(), &folder, shard)? {
            missing.push(shard.index());
        }
    }
    if !queued.is_empty() {
        say(format_args!(
            "{} of {} shards are in the queue",
            queued.len(),
            args.array
        ))?;
    }
    if missing.is_empty() && !queued.is_empty() {
        return Ok(());
    }
    let array = match missing.is_empty() {
        true => None,
        false => Some(submit(&jobs.shards(&missing), &folder)?),
    };
    let said = say(match &array {
        Some(id) => format!(
            "submitted {} of {} shards as job {id}",
            missing.len(),
            args.array
        ),
        None => format!("all {} shards are done", args.array),
    });
    // Whatever became of the line: shards without a merge would be lost work.
    let merge = submit(&jobs.merge(array.as_deref()), &folder)?;
    said?;
    say(format_args!(
        "submitted their merge as job {merge}; the same command submits again what fails"
    ))
}

/// Whether a shard's journal says what came of all its work.
fn is_done(study: &dyn AnyStudy, folder: &Path, shard: Shard) -> Result<bool> {
    let path = folder.join(shard.file_name(JOURNAL_FILE));
    let Some((begun, journal)) = Journal::read(&path)? else {
        return Ok(false);
    };
    begun.check_same(study.identity(), &path.display().to_string())?;
    Ok(study.n_left(Part::Shard(shard), &journal) == 0)
}

/// What the jobs of a study have in common.
struct Jobs<'a> {
    args: &'a Args,
    study: String,
    program: String,
    /// The study and the folder, as arguments.
    arguments: String,
}

impl<'a> Jobs<'a> {
    fn new(args: &'a Args, folder: &Path) -> Result<Self> {
        let absolute = |path: &Path| {
            let absolute = std::path::absolute(path);
            absolute.map_err(|e| Error::io(path, "read", e))
        };
        let program = std::env::current_exe().map_err(|e| Error::io("bubbletouch", "read", e))?;
        let mut words = vec![absolute(&args.study.study)?.into_os_string()];
        words.extend(["--out".into(), absolute(folder)?.into_os_string()]);
        if let Some(objects) = &args.study.objects {
            words.extend(["--objects".into(), absolute(objects)?.into_os_string()]);
        }
        if let Some(seed) = args.study.seed {
            words.extend(["--seed".into(), seed.to_string().into()]);
        }
        let words: Vec<String> = words
            .iter()
            .map(|word| quoted(&word.to_string_lossy()))
            .collect();
        Ok(Self {
            args,
            study: args.study.name()?,
            program: quoted(&program.to_string_lossy()),
            arguments: words.join(" "),
        })
    }

    /// The name of jobs in the queue.
    fn name(&self, what: &str) -> String {
        format!("bubbletouch-{}-{what}-of-{}", self.study, self.args.array)
    }

    fn shards(&self, indices: &[usize]) -> Job {
        let indices: Vec<String> = indices.iter().map(usize::to_string).collect();
        let threads = self.args.study.threads.unwrap_or(1);
        let mut options = self.options(threads);
        options.push(format!("--array={}", indices.join(",")));
        // A job that is pre-empted goes back into the queue, and on where it stopped.
        options.push("--requeue".to_owned());
        let (program, arguments) = (&self.program, &self.arguments);
        let shard = format!("\"$SLURM_ARRAY_TASK_ID\"/{}", self.args.array);
        Job {
            name: self.name("shards"),
            options,
            command: format!(
                "{program} run {arguments} --threads {threads} --quiet --shard {shard}"
            ),
        }
    }

    fn merge(&self, after: Option<&str>) -> Job {
        let mut options = self.options(1);
        // After any end: the merge says which cells are missing, if some are.
        options.extend(after.map(|id| format!("--dependency=afterany:{id}")));
        Job {
            name: self.name("merge"),
            options,
            command: format!("{} merge {} --quiet", self.program, self.arguments),
        }
    }

    fn options(&self, threads: usize) -> Vec<String> {
        let given = [
            ("time", &self.args.time),
            ("mem", &self.args.mem),
            ("partition", &self.args.partition),
        ];
        let given = given.into_iter().filter_map(|(name, value)| {
            let value = value.as_ref()?;
            Some(format!("--{name}={value}"))
        });
        given
            .chain([format!("--cpus-per-task={threads}")])
            .collect()
    }
}

/// A word as the shell takes it, whatever is in it.
fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn a_quoted_word_is_one_word_to_the_shell() {
        assert_eq!(quoted("results/it's $HOME"), r"'results/it'\''s $HOME'");
    }
}
