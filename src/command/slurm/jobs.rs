//! Jobs in the queue of the cluster manager Slurm.

use bubbletouch::files::write_bytes;
use bubbletouch::{Error, Result};
use std::io;
use std::path::Path;
use std::process::Command;

/// Submits a cluster job, or an array of jobs, that runs a shell command; returns the number of the job. The script and the output of the job are
/// files in the folder `slurm` of a study's results, named after the job.
pub fn submit(name: &str, options: &[String], line: &str, results: &Path) -> Result<String> {
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
pub fn output_pattern(results: &Path, name: &str) -> Result<String> {
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
pub fn queued_shards(name: &str) -> Result<Vec<usize>> {
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
