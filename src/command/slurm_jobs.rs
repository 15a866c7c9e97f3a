//! Jobs in the queue of Slurm.

use bubbletouch::files::write_bytes;
use bubbletouch::{Error, Result};
use std::io;
use std::path::Path;
use std::process::Command;

/// A job, or an array of them.
pub struct Job {
    /// Its name in the queue; its script and what it says are files of that name.
    pub name: String,
    /// Options of sbatch.
    pub options: Vec<String>,
    /// What it runs.
    pub command: String,
}

/// Writes a job's script into the folder `slurm` of a study's results and puts it into the queue; its number.
pub fn submit(job: &Job, folder: &Path) -> Result<String> {
    let folder = folder.join("slurm");
    std::fs::create_dir_all(&folder).map_err(|e| Error::io(&folder, "create folder", e))?;
    let script = folder.join(format!("{}.sh", job.name));
    write_bytes(
        &script,
        format!("#!/bin/sh\nexec {}\n", job.command).as_bytes(),
    )?;
    let said = folder.join(format!("{}.%j.txt", job.name));
    let mut sbatch = Command::new("sbatch");
    sbatch
        .args(["--parsable", "--job-name", &job.name])
        .arg("--output")
        .arg(said);
    let answer = answer(sbatch.args(&job.options).arg(&script))?;
    // With several clusters it is `number;cluster`.
    Ok(answer
        .split(';')
        .next()
        .unwrap_or_default()
        .trim()
        .to_owned())
}

/// The shards whose jobs of this name wait or run.
pub fn queued_shards(name: &str) -> Result<Vec<usize>> {
    let mut squeue = Command::new("squeue");
    // One line for each job of an array: its number in the array.
    squeue.args(["--noheader", "--array", "--name", name, "--format", "%K"]);
    let answer = answer(&mut squeue)?;
    Ok(answer
        .lines()
        .filter_map(|line| line.trim().parse().ok())
        .collect())
}

/// What a command of Slurm says; the error says what it said instead.
fn answer(command: &mut Command) -> Result<String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command.output().map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => {
            let allowed = "a machine from which jobs can be submitted (without Slurm: bubbletouch run --shard)";
            Error::input(&name, "there is no such command here", allowed)
        }
        _ => Error::io(&name, "run", error),
    })?;
    match output.status.success() {
        true => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
        false => {
            let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
            Err(Error::input(&name, said, "what Slurm takes"))
        }
    }
}
