//! A study as a job array on a real Slurm cluster of one node, which the test starts. One shard is killed, and the same command continues it.
#![cfg(target_os = "linux")]

use crate::command::{Case, CommandLine, filled, says, skip};
use crate::faults::pieces;
use bubbletouch::study::journal::Journal;
use std::fmt::Display;
use std::fs::{self, Permissions};
use std::net::TcpListener;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

const STUDY: &str = include_str!("../fixtures/texts/slurm.toml");

/// Daemons of a cluster of one node; they end with the test.
struct Cluster {
    folder: PathBuf,
    daemons: Vec<Child>,
}

impl Cluster {
    /// Starts a cluster in a folder; the error states why there is none.
    fn start(folder: &Path) -> Result<Self, String> {
        let sbin = |name: &str| {
            let found = ["/usr/sbin", "/usr/bin", "/sbin", "/usr/local/sbin"]
                .map(|folder| Path::new(folder).join(name))
                .into_iter()
                .find(|path| path.exists());
            found.ok_or(format!("there is no {name} on this machine"))
        };
        let (munged, slurmctld, slurmd) = (sbin("munged")?, sbin("slurmctld")?, sbin("slurmd")?);
        let write = || -> std::io::Result<()> {
            for name in ["munge", "state", "spool"] {
                fs::create_dir(folder.join(name))?;
                fs::set_permissions(folder.join(name), Permissions::from_mode(0o700))?;
            }
            let key = folder.join("munge/key");
            fs::write(&key, [7; 128])?;
            fs::set_permissions(&key, Permissions::from_mode(0o400))?;
            fs::write(folder.join("slurm.conf"), configuration(folder))
        };
        write().map_err(|e| e.to_string())?;
        let munge = folder.join("munge").display().to_string();
        let munge_options = format!(
            "--foreground --force --key-file={munge}/key --socket={munge}/socket --pid-file={munge}/pid --log-file={munge}/log --seed-file={munge}/seed"
        );
        let mut cluster = Self {
            folder: folder.to_owned(),
            daemons: Vec::new(),
        };
        cluster.daemon(&munged, &munge_options)?;
        sleep(Duration::from_millis(500));
        cluster.daemon(&slurmctld, "-D")?;
        cluster.daemon(&slurmd, "-D")?;
        let start = Instant::now();
        let state = ["--noheader", "--format", "%T"];
        while cluster.ask("sinfo", &state).trim() != "idle" {
            if start.elapsed() > Duration::from_secs(20) {
                return Err("its node is not ready after 20 s".to_owned());
            }
            sleep(Duration::from_millis(200));
        }
        Ok(cluster)
    }

    fn daemon(&mut self, program: &Path, arguments: &str) -> Result<(), String> {
        let mut command = Command::new(program);
        let command = self.with_cluster(command.args(arguments.words()));
        command.stdout(Stdio::null()).stderr(Stdio::null());
        let daemon = command.spawn().map_err(|e| e.to_string())?;
        self.daemons.push(daemon);
        Ok(())
    }

    /// Lets a command use this cluster.
    fn with_cluster<'c>(&self, command: &'c mut Command) -> &'c mut Command {
        command.env("SLURM_CONF", self.folder.join("slurm.conf"))
    }

    fn ask(&self, program: &str, arguments: &[&str]) -> String {
        let mut command = Command::new(program);
        let output = self.with_cluster(command.args(arguments)).output();
        let output = output.map(|output| output.stdout).unwrap_or_default();
        String::from_utf8(output).unwrap()
    }

    /// Runs the submit command and asserts success.
    fn submit(&self, case: &Case) -> String {
        let line = "slurm study.toml --out jobs --array 8 --time 10";
        let mut command = case.command(line);
        succeeded(self.with_cluster(&mut command))
    }

    fn wait_until_empty(&self) {
        let start = Instant::now();
        while !self.ask("squeue", &["--noheader"]).trim().is_empty() {
            let is_late = start.elapsed() > Duration::from_secs(300);
            assert!(!is_late, "jobs do not end");
            sleep(Duration::from_millis(300));
        }
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        for daemon in self.daemons.iter_mut().rev() {
            let _ = daemon.kill();
            let _ = daemon.wait();
        }
    }
}

fn configuration(folder: &Path) -> String {
    let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap();
    let host = host.trim().split('.').next().unwrap();
    // The two ports are held at the same time, so that they differ.
    let free = [(); 2].map(|()| TcpListener::bind("127.0.0.1:0").unwrap());
    let [ctld, d] = free.map(|listener| listener.local_addr().unwrap().port());
    let cpus = std::thread::available_parallelism().unwrap();
    let folder = folder.display();
    let text = include_str!("../fixtures/texts/slurm.conf");
    let values: [(&str, &dyn Display); 3] = [("ctld", &ctld), ("d", &d), ("cpus", &cpus)];
    filled(
        &filled(text, &values),
        &[("host", &host), ("folder", &folder)],
    )
}

/// Runs a command and asserts success; returns the text of its standard output.
fn succeeded(command: &mut Command) -> String {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn eight_jobs_of_which_one_is_killed_make_the_tables_of_a_single_run() {
    let case = Case::new();
    let folder = case.path("cluster");
    fs::create_dir(&folder).unwrap();
    let cluster = match Cluster::start(&folder) {
        Ok(cluster) => cluster,
        Err(reason) => {
            skip(format!("no Slurm could be started: {reason}"));
            return;
        }
    };
    case.file("study.toml", STUDY);
    let said = cluster.submit(&case);
    says(&said, &["submitted 8 of 8 shards"]);
    // While the jobs are in the queue, they are not submitted again.
    let said = cluster.submit(&case);
    is_in_queue(&said);
    let queue = cluster.ask("squeue", &["--noheader", "--format", "%F"]);
    let job = queue.lines().next().unwrap_or_default().trim();
    let journal = case.path("jobs/journal.3-of-8.jsonl");
    let start = Instant::now();
    while pieces(&journal).is_empty() {
        let is_late = start.elapsed() > Duration::from_secs(200);
        assert!(!is_late, "the third job does not begin");
        sleep(Duration::from_millis(5));
    }
    cluster.ask("scancel", &["--signal=KILL", "--full", &format!("{job}_3")]);
    cluster.wait_until_empty();
    let finished = pieces(&journal).len();
    assert!(!case.path("jobs/summary.csv").exists(), "{finished} items");
    let said = cluster.submit(&case);
    says(&said, &["submitted 1 of 8 shards"]);
    cluster.wait_until_empty();
    assert!(pieces(&journal).len() > finished);
    case.succeeds("run study.toml --out whole");
    let tables = "accuracy.csv summary.csv confusion.csv comparison.csv study.toml";
    case.same_files(["whole", "jobs"], &tables.words());
    let said = cluster.submit(&case);
    says(&said, &["all 8 shards are done"]);
    cluster.wait_until_empty();
}

#[test]
fn without_slurm_the_command_says_so() {
    let case = Case::with("study.toml", STUDY);
    let mut command = case.command(&["slurm", "study.toml", "--array", "2"]);
    let output = command.env("PATH", case.folder()).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8_lossy(&output.stderr);
    says(&error, &["squeue: the command is not installed"]);
    assert!(!case.path("results").exists(), "a folder was written");
}

/// Small study of two shards with at least two work items each.
const SMALL: &str = include_str!("../fixtures/texts/slurm_small.toml");

/// Creates a queue in which jobs stay until the test removes them: `squeue` and `sbatch` scripts that keep names in a file.
fn fake_slurm(case: &Case) {
    let bin = case.path("bin");
    fs::create_dir(&bin).unwrap();
    let queue = case.path("queue").display().to_string();
    // As squeue does, the script reads a comma as the end of a name.
    let squeue = format!(
        "#!/bin/sh\nwhile [ $# -gt 0 ]; do [ \"$1\" = --name ] && name=$2; shift; done\n\
         echo \"$name\" | tr , '\\n' | grep -qxf - -- '{queue}' 2>/dev/null && printf '1\\n2\\n'\nexit 0\n"
    );
    let outputs = case.path("outputs").display().to_string();
    let sbatch = format!(
        "#!/bin/sh\nwhile [ $# -gt 0 ]; do\n[ \"$1\" = --job-name ] && name=$2\n\
         [ \"$1\" = --output ] && printf '%s\\n' \"$2\" >> '{outputs}'\nshift; done\n\
         printf '%s\\n' \"$name\" >> '{queue}'\necho 17\n"
    );
    for (name, script) in [("squeue", squeue), ("sbatch", sbatch)] {
        let path = bin.join(name);
        fs::write(&path, script).unwrap();
        fs::set_permissions(&path, Permissions::from_mode(0o755)).unwrap();
    }
}

/// Submits two shards of a study to the queue of [`fake_slurm`], with further arguments.
fn submit_two(case: &Case, study: &str, more: &str) -> String {
    let more = more.words();
    let arguments = [&["slurm", study, "--array", "2"], &more[..]].concat();
    let path = format!("{}:/usr/bin:/bin", case.path("bin").display());
    succeeded(case.command(&arguments).env("PATH", path))
}

/// Asserts that jobs are in the queue and are not submitted again.
fn is_in_queue(said: &str) {
    says(said, &["are in the queue"]);
    assert!(!said.contains("submitted"), "{said}");
}

#[test]
fn runs_into_other_folders_or_with_other_seeds_are_other_jobs() {
    let case = Case::new();
    fake_slurm(&case);
    case.file("study.toml", SMALL);
    fs::create_dir(case.path("sub")).unwrap();
    case.file("sub/study.toml", SMALL);
    for run in ["--out a", "--out b", "--out c --seed 5", "--out c"] {
        let said = submit_two(&case, "study.toml", run);
        says(&said, &["submitted 2 of 2 shards"]);
    }
    // For any form of a path, the command finds the run that is in the queue.
    for folder in ["a", "./a", "sub/../a"] {
        is_in_queue(&submit_two(&case, "study.toml", &format!("--out {folder}")));
    }
}

#[test]
fn characters_that_slurm_interprets_do_not_change_what_a_job_is_called_or_where_it_writes() {
    let case = Case::new();
    fake_slurm(&case);
    let long = format!("{}.toml", "n".repeat(200));
    for study in [
        "a,b.toml",
        "50% noise.toml",
        "a\nb.toml",
        "é [1].toml",
        &long,
    ] {
        case.file(study, SMALL);
        for expected in ["submitted 2 of 2 shards", "are in the queue"] {
            let said = submit_two(&case, study, "--out 50%j");
            says(&said, &[expected]);
        }
    }
    let outputs = case.read("outputs");
    for output in outputs.lines() {
        assert!(output.starts_with("50%%j/slurm/bubbletouch-"), "{output}");
        assert!(output.ends_with(".%j.txt"), "{output}");
    }
    let error = case.refuses(&["slurm", "a,b.toml", "--array", "2", "--out", "a\\b"]);
    says(&error, &["--out", "without backslashes"]);
    assert!(!case.path("a\\b").exists());
}

/// Returns the lines of a journal without the first one.
fn records(journal: &Path) -> Vec<(String, serde_json::Value)> {
    let text = fs::read_to_string(journal).unwrap();
    let record = |line: &str| {
        let (_, json) = line.split_once(' ').unwrap();
        let json: serde_json::Value = serde_json::from_str(json).unwrap();
        let key = json["key"].as_str().unwrap().to_owned();
        (key, json["record"].clone())
    };
    text.lines().skip(1).map(record).collect()
}

/// Writes journals of shards: for the first and for each other record of a whole run, whether each of two shards has it and whether it failed there.
fn write_shards(case: &Case, folder: &str, shards: impl Fn(bool) -> [Option<bool>; 2]) {
    let whole = case.path("whole/journal.jsonl");
    let (identity, _) = Journal::read(&whole).unwrap().unwrap();
    fs::create_dir_all(case.path(folder)).unwrap();
    let open = |shard: usize| {
        let path = case
            .path(folder)
            .join(format!("journal.{shard}-of-2.jsonl"));
        Journal::open(&path, &identity).unwrap()
    };
    let journals = [open(1), open(2)];
    for (number, (key, record)) in records(&whole).into_iter().enumerate() {
        for (journal, state) in journals.iter().zip(shards(number == 0)) {
            let failed = serde_json::json!({"Err": "no room"});
            match state {
                Some(true) => journal.keep(&key, &failed).unwrap(),
                Some(false) => journal.keep(&key, &record).unwrap(),
                None => {}
            }
        }
    }
}

#[test]
fn what_failed_in_one_shard_and_succeeded_in_another_has_succeeded_and_what_failed_in_all_runs_again()
 {
    let case = Case::with("study.toml", SMALL);
    case.succeeds("run study.toml --out whole");
    let n = records(&case.path("whole/journal.jsonl")).len();
    assert!(n >= 2, "{n} work items");
    // States of the first item and of the other items in both shards; true if the item failed there.
    let (failed, done) = (Some(true), Some(false));
    for (folder, first, others) in [
        ("first", [failed, done], [done, None]),
        ("second", [done, failed], [done, None]),
        ("both", [failed, failed], [done, None]),
        ("all", [failed, None], [failed, None]),
    ] {
        write_shards(
            &case,
            folder,
            |is_first| if is_first { first } else { others },
        );
        case.succeeds(&["merge", "study.toml", "--out", folder]);
        let tables = ["accuracy.csv", "summary.csv", "failures.csv"];
        case.same_files(["whole", folder], &tables);
    }
}

#[test]
fn a_shard_with_a_failed_work_item_is_submitted_again() {
    let case = Case::new();
    fake_slurm(&case);
    case.file("study.toml", SMALL);
    case.succeeds("run study.toml --out whole");
    write_shards(&case, "failed", |_| [Some(true), Some(false)]);
    let said = submit_two(&case, "study.toml", "--out failed");
    says(&said, &["submitted 1 of 2 shards"]);
    write_shards(&case, "done", |_| [Some(false), Some(false)]);
    let said = submit_two(&case, "study.toml", "--out done");
    says(&said, &["all 2 shards are done"]);
}
