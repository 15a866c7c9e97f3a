//! `bubbletouch slurm`: submits the shards of a study as an array of cluster jobs, followed by a job that merges them.

use crate::command::options::study_run::ResultsArgs;
use crate::command::terminal::{note, output_folder, say};
use bubbletouch::files::write_bytes;
use bubbletouch::kinds::{self, AnyStudy};
use bubbletouch::shell_line::shell_line;
use bubbletouch::study::journal::{JOURNAL_FILE, Journal};
use bubbletouch::study::work_items::Part;
use bubbletouch::study::{Shard, sha256};
use bubbletouch::{Error, Result};
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Maximum number of jobs in a job array, which is the largest value that Slurm can be configured to allow.
const MAX_JOBS: usize = 4_000_000;

/// Digits of the hash in a job's name. Fewer: two runs may share a name; more: squeue cuts the name.
const HASH_DIGITS: usize = 12;
/// Maximum number of characters of the study's name in a job's name. The names of scripts then fit into the 255 bytes that file systems allow.
const MAX_NAME: usize = 64;

/// Submit a study as an array of Slurm jobs, then its merge
///
/// If the command runs again, it submits the shards that are neither finished nor queued.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch slurm study.toml --array 8 --threads 4 --time 2:00:00 --mem 4G"
)]
pub struct Args {
    #[command(flatten)]
    results: ResultsArgs,
    /// Divide the study into N jobs
    #[arg(long, value_name = "N", help_heading = "Jobs")]
    array: usize,
    /// Limit the time of a job, in sbatch's format: 2:00:00
    #[arg(long, value_name = "TIME", help_heading = "Jobs")]
    time: Option<String>,
    /// Limit the memory of a job, in sbatch's format: 4G
    #[arg(long, value_name = "SIZE", help_heading = "Jobs")]
    mem: Option<String>,
    /// Submit to this partition of the cluster
    #[arg(long, value_name = "NAME", help_heading = "Jobs")]
    partition: Option<String>,
}

pub fn slurm(args: &Args) -> Result<()> {
    let n = args.array;
    if !(1..=MAX_JOBS).contains(&n) {
        let allowed = format!("1 to {MAX_JOBS} jobs");
        return Err(Error::input("--array", n, allowed));
    }
    let folder = args.results.folder()?;
    output_pattern(&folder, "")?;
    let source = args.results.study.source(&folder)?;
    kinds::check_folder(&source.text, &folder)?;
    let study = kinds::load(&source)?;
    let mut finished = Journal::read_records(&folder.join(JOURNAL_FILE))?;
    if folder.exists() {
        finished.take_from_shards(study.identity(), [folder.as_path()])?;
    }
    for error in study.check_elsewhere(Part::All, &finished)? {
        note(format_args!("note: the nodes have to have it: {error}"));
    }
    // Without Slurm, nothing is written.
    let queued = queued_shards(&args.name("shards")?)?;
    output_folder(&folder)?;
    let mut missing = Vec::new();
    for shard in Shard::all(n) {
        let is_queued = queued.contains(&shard.index());
        if !is_queued && !is_done(study.as_ref(), &folder, shard)? {
            missing.push(shard.index().to_string());
        }
    }
    if !queued.is_empty() {
        let n_queued = queued.len();
        say(format_args!("{n_queued} of {n} shards are in the queue"))?;
        if missing.is_empty() {
            return Ok(());
        }
    }
    let (shards, said) = match missing.len() {
        0 => (None, say(format_args!("all {n} shards are done"))),
        n_missing => {
            let id = args.submit_shards(&missing, &folder)?;
            let said = format!("submitted {n_missing} of {n} shards as job {id}");
            (Some(id), say(said))
        }
    };
    // Submitted even if the message could not be printed: shards without a merge would be lost.
    let merge = args.submit_merge(shards.as_deref(), &folder)?;
    said?;
    say(format_args!(
        "submitted their merge as job {merge}; the same command submits failed shards again"
    ))
}

/// Returns whether all work items of a shard have succeeded, according to the shard's journal or the merged journal.
fn is_done(study: &dyn AnyStudy, folder: &Path, shard: Shard) -> Result<bool> {
    let mut known = None::<Journal>;
    for name in [shard.file_name(JOURNAL_FILE), JOURNAL_FILE.to_owned()] {
        let path = folder.join(name);
        let Some((begun, journal)) = Journal::read(&path)? else {
            continue;
        };
        let place = path.display().to_string();
        study
            .identity()
            .check_same((&begun, journal.records()), &place)?;
        match &mut known {
            Some(known) => known.take_from(journal)?,
            None => known = Some(journal),
        }
    }
    Ok(known.is_some_and(|known| study.n_without_success(Part::Shard(shard), &known) == 0))
}

/// Returns the absolute path with symbolic links resolved, also of a file or folder that does not exist yet.
fn real_path(path: &Path) -> Result<PathBuf> {
    let path = std::path::absolute(path).map_err(|e| Error::io(path, "find", e))?;
    let known = path
        .ancestors()
        .find_map(|known| Some((known, known.canonicalize().ok()?)));
    Ok(match known {
        Some((known, real)) => {
            let rest = path.iter().skip(known.iter().count());
            real.iter().chain(rest).collect()
        }
        None => path,
    })
}

impl Args {
    /// Returns the name of the jobs in the cluster's queue. Jobs have the same name if they write the same results. The name contains a hash of the study's
    /// file, of the options that replace parts of it, and of the folder. Characters that Slurm interprets, such as the comma between the names of a list, are
    /// replaced by `_`.
    fn name(&self, what: &str) -> Result<String> {
        let study = &self.results.study;
        let mut made_of = study.arguments();
        made_of[0] = real_path(&study.study)?.display().to_string();
        made_of.push(real_path(&self.results.folder()?)?.display().to_string());
        let hash = sha256(made_of.join("\n"));
        let plain = |c: char| match c.is_ascii_alphanumeric() || "-_.".contains(c) {
            true => c,
            false => '_',
        };
        let name: String = study.name()?.chars().take(MAX_NAME).map(plain).collect();
        let (hash, n) = (&hash[..HASH_DIGITS], self.array);
        Ok(format!("bubbletouch-{name}-{hash}-{what}-of-{n}"))
    }

    fn submit_shards(&self, missing: &[String], folder: &Path) -> Result<String> {
        let threads = self.results.study.threads.unwrap_or(1);
        let mut options = self.options(threads);
        options.push(format!("--array={}", missing.join(",")));
        // A pre-empted job returns to the queue and later continues where it stopped.
        options.push("--requeue".to_owned());
        let shard = format!("\"$SLURM_ARRAY_TASK_ID\"/{}", self.array);
        let line = self.line("run", folder)?;
        let line = format!("{line} --threads {threads} --shard {shard}");
        submit(&self.name("shards")?, &options, &line, folder)
    }

    fn submit_merge(&self, shards: Option<&str>, folder: &Path) -> Result<String> {
        let mut options = self.options(1);
        // Runs after any end of the shards: the merge lists the missing configurations.
        options.extend(shards.map(|id| format!("--dependency=afterany:{id}")));
        let line = self.line("merge", folder)?;
        submit(&self.name("merge")?, &options, &line, folder)
    }

    /// Returns the command line that a cluster job runs. Slurm runs it in the folder where it was submitted, so that paths need not be absolute.
    fn line(&self, subcommand: &str, folder: &Path) -> Result<String> {
        let program = std::env::current_exe().map_err(|e| Error::io("bubbletouch", "read", e))?;
        let mut words = vec![program.display().to_string(), subcommand.to_owned()];
        words.extend(self.results.study.arguments());
        words.push(format!("--out={}", folder.display()));
        words.push("--quiet".to_owned());
        Ok(shell_line(&words))
    }

    /// Options of sbatch.
    fn options(&self, threads: usize) -> Vec<String> {
        let mut options = vec![format!("--cpus-per-task={threads}")];
        let given = [
            ("time", &self.time),
            ("mem", &self.mem),
            ("partition", &self.partition),
        ];
        for (name, value) in given {
            options.extend(value.iter().map(|value| format!("--{name}={value}")));
        }
        options
    }
}

/// Submits a cluster job, or an array of jobs, that runs a shell command; returns the number of the job. The script and the output of the job are
/// files in the folder `slurm` of a study's results, named after the job.
fn submit(name: &str, options: &[String], line: &str, results: &Path) -> Result<String> {
    let folder = results.join("slurm");
    std::fs::create_dir_all(&folder).map_err(|e| Error::io(&folder, "create folder", e))?;
    // A path that begins with a dash would be an option.
    let script = Path::new(".").join(&folder).join(format!("{name}.sh"));
    write_bytes(&script, format!("#!/bin/sh\nexec {line}\n").as_bytes())?;
    let mut sbatch = Command::new("sbatch");
    sbatch.args(["--parsable", "--job-name", name]);
    sbatch.args(["--output", &output_pattern(results, name)?]);
    sbatch.args(options).arg(&script);
    let answer = answer(&mut sbatch)?;
    // With several clusters, the output is `number;cluster`.
    let number = answer.split(';').next().unwrap_or_default();
    Ok(number.trim().to_owned())
}

/// Returns the filename pattern of a job's output in a folder of results. In a pattern, `%%` is a percent sign and `%j` is the number of the job (manual page of
/// sbatch, "filename pattern").
///
/// # Errors
/// If the path of the folder contains a character that a pattern cannot express.
fn output_pattern(results: &Path, name: &str) -> Result<String> {
    let folder = results.join("slurm");
    // A backslash turns off all replacements of a pattern.
    let is_plain = |path: &&str| !path.contains(['\\', '\n', '\r']);
    let path = folder.to_str().filter(is_plain).ok_or_else(|| {
        let allowed = "a path in UTF-8 without backslashes and line breaks, as sbatch requires";
        Error::input("--out", format!("{results:?}"), allowed)
    })?;
    Ok(format!("{}/{name}.%j.txt", path.replace('%', "%%")))
}

/// Returns the shards whose cluster jobs with this name are waiting or running.
fn queued_shards(name: &str) -> Result<Vec<usize>> {
    let mut squeue = Command::new("squeue");
    // The output has one line for each job of an array: the job's number in the array.
    squeue.args(["--noheader", "--array", "--name", name, "--format", "%K"]);
    let answer = answer(&mut squeue)?;
    let numbers = answer.lines().map(|line| line.trim().parse());
    Ok(numbers.flatten().collect())
}

/// Runs a command of Slurm and returns its output; the error contains the message of the command.
fn answer(command: &mut Command) -> Result<String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command.output().map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => {
            let allowed = "a machine from which jobs can be submitted (without Slurm: bubbletouch run --shard)";
            Error::input(&name, "the command is not installed", allowed)
        }
        _ => Error::io(&name, "run", error),
    })?;
    match output.status.success() {
        true => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
        false => {
            let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
            Err(Error::input(&name, said, "options that Slurm accepts"))
        }
    }
}
