//! A study as a job array on a real Slurm cluster of one node, which the test starts. One shard is killed, and the same command continues it.
#![cfg(target_os = "linux")]

use crate::command::{Case, says};
use bubbletouch::study::journal::Journal;
use std::fs;
use std::io::Write;
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
        for name in ["munge", "state", "spool"] {
            fs::create_dir(folder.join(name)).map_err(|e| e.to_string())?;
            let private = fs::Permissions::from_mode(0o700);
            fs::set_permissions(folder.join(name), private).map_err(|e| e.to_string())?;
        }
        let key = folder.join("munge/key");
        fs::write(&key, [7; 128]).map_err(|e| e.to_string())?;
        fs::set_permissions(&key, fs::Permissions::from_mode(0o400)).map_err(|e| e.to_string())?;
        fs::write(folder.join("slurm.conf"), configuration(folder)).map_err(|e| e.to_string())?;
        let munge = |file: &str| folder.join("munge").join(file).display().to_string();
        let munge_options = [
            "--foreground".to_owned(),
            "--force".to_owned(),
            format!("--key-file={}", munge("key")),
            format!("--socket={}", munge("socket")),
            format!("--pid-file={}", munge("pid")),
            format!("--log-file={}", munge("log")),
            format!("--seed-file={}", munge("seed")),
        ];
        let mut cluster = Self {
            folder: folder.to_owned(),
            daemons: Vec::new(),
        };
        cluster.daemon(&munged, &munge_options)?;
        sleep(Duration::from_millis(500));
        cluster.daemon(&slurmctld, &["-D".to_owned()])?;
        cluster.daemon(&slurmd, &["-D".to_owned()])?;
        let start = Instant::now();
        while cluster
            .ask("sinfo", &["--noheader", "--format", "%T"])
            .trim()
            != "idle"
        {
            if start.elapsed() > Duration::from_secs(20) {
                return Err("its node is not ready after 20 s".to_owned());
            }
            sleep(Duration::from_millis(200));
        }
        Ok(cluster)
    }

    fn daemon(&mut self, program: &Path, arguments: &[String]) -> Result<(), String> {
        let mut command = Command::new(program);
        command
            .args(arguments)
            .env("SLURM_CONF", self.folder.join("slurm.conf"));
        command.stdout(Stdio::null()).stderr(Stdio::null());
        self.daemons
            .push(command.spawn().map_err(|e| e.to_string())?);
        Ok(())
    }

    fn ask(&self, program: &str, arguments: &[&str]) -> String {
        let mut command = Command::new(program);
        command
            .args(arguments)
            .env("SLURM_CONF", self.folder.join("slurm.conf"));
        let output = command
            .output()
            .map(|output| output.stdout)
            .unwrap_or_default();
        String::from_utf8(output).unwrap()
    }

    /// Runs the submit command and asserts success.
    fn submit(&self, case: &Case) -> String {
        let arguments = [
            "slurm",
            "study.toml",
            "--out",
            "jobs",
            "--array",
            "8",
            "--time",
            "10",
        ];
        let mut command = case.command(&arguments);
        let output = command
            .env("SLURM_CONF", self.folder.join("slurm.conf"))
            .output()
            .unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{error}");
        String::from_utf8(output.stdout).unwrap()
    }

    fn wait_until_empty(&self) {
        let start = Instant::now();
        while !self.ask("squeue", &["--noheader"]).trim().is_empty() {
            assert!(
                start.elapsed() < Duration::from_secs(300),
                "jobs do not end"
            );
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
    format!(
        "ClusterName=test\nSlurmctldHost={host}(127.0.0.1)\nSlurmUser=root\nSlurmdUser=root\n\
         AuthType=auth/munge\nAuthInfo=socket={folder}/munge/socket\nStateSaveLocation={folder}/state\n\
         SlurmdSpoolDir={folder}/spool\nSlurmctldPidFile={folder}/ctld.pid\nSlurmdPidFile={folder}/d.pid\n\
         SlurmctldLogFile={folder}/ctld.log\nSlurmdLogFile={folder}/d.log\n\
         SlurmctldPort={ctld}\nSlurmdPort={d}\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\n\
         SelectType=select/cons_tres\nSelectTypeParameters=CR_CPU\nReturnToService=2\nMpiDefault=none\n\
         SchedulerParameters=sched_interval=1,batch_sched_delay=0\nKillWait=1\n\
         NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN\n\
         PartitionName=test Nodes={host} Default=YES MaxTime=INFINITE State=UP\n"
    )
}

fn n_configurations(journal: &Path) -> usize {
    let text = fs::read_to_string(journal).unwrap_or_default();
    text.matches("\"key\":\"piece ").count()
}

#[test]
fn eight_jobs_of_which_one_is_killed_make_the_tables_of_a_single_run() {
    let case = Case::new();
    let folder = case.path("cluster");
    fs::create_dir(&folder).unwrap();
    let cluster = match Cluster::start(&folder) {
        Ok(cluster) => cluster,
        Err(reason) => {
            writeln!(
                std::io::stderr(),
                "SKIPPED: no Slurm could be started: {reason}"
            )
            .expect("standard error takes a line");
            return;
        }
    };
    case.file("study.toml", STUDY);
    let said = cluster.submit(&case);
    says(&said, &["submitted 8 of 8 shards"]);
    // While the jobs are in the queue, they are not submitted again.
    let said = cluster.submit(&case);
    assert!(
        said.contains("are in the queue") && !said.contains("submitted"),
        "{said}"
    );
    let queue = cluster.ask("squeue", &["--noheader", "--format", "%F"]);
    let job = queue.lines().next().unwrap_or_default().trim();
    let journal = case.path("jobs/journal.3-of-8.jsonl");
    let start = Instant::now();
    while n_configurations(&journal) == 0 {
        assert!(
            start.elapsed() < Duration::from_secs(200),
            "the third job does not begin"
        );
        sleep(Duration::from_millis(5));
    }
    cluster.ask("scancel", &["--signal=KILL", "--full", &format!("{job}_3")]);
    cluster.wait_until_empty();
    let finished = n_configurations(&journal);
    assert!(
        !case.path("jobs/summary.csv").exists(),
        "{finished} cells of the killed job"
    );
    let said = cluster.submit(&case);
    says(&said, &["submitted 1 of 8 shards"]);
    cluster.wait_until_empty();
    assert!(n_configurations(&journal) > finished);
    case.succeeds(&["run", "study.toml", "--out", "whole"]);
    for name in [
        "accuracy.csv",
        "summary.csv",
        "confusion.csv",
        "comparison.csv",
        "study.toml",
    ] {
        let read = |folder: &str| fs::read(case.path(folder).join(name)).unwrap();
        assert!(read("whole") == read("jobs"), "{name}");
    }
    let said = cluster.submit(&case);
    says(&said, &["all 8 shards are done"]);
    cluster.wait_until_empty();
}

#[test]
fn without_slurm_the_command_says_so() {
    let case = Case::new();
    case.file("study.toml", STUDY);
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
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    }
}

/// Submits two shards to the queue of [`fake_slurm`], with further arguments.
fn submit_two(case: &Case, more: &[&str]) -> String {
    let arguments = [&["slurm", "study.toml", "--array", "2"], more].concat();
    let path = format!("{}:/usr/bin:/bin", case.path("bin").display());
    let output = case.command(&arguments).env("PATH", path).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn runs_into_other_folders_or_with_other_seeds_are_other_jobs() {
    let case = Case::new();
    fake_slurm(&case);
    case.file("study.toml", SMALL);
    fs::create_dir(case.path("sub")).unwrap();
    case.file("sub/study.toml", SMALL);
    let runs: [&[&str]; 4] = [
        &["--out", "a"],
        &["--out", "b"],
        &["--out", "c", "--seed", "5"],
        &["--out", "c"],
    ];
    for run in runs {
        let said = submit_two(&case, run);
        assert!(said.contains("submitted 2 of 2 shards"), "{run:?}: {said}");
    }
    // For any form of a path, the command finds the run that is in the queue.
    for run in [&["--out", "a"], &["--out", "./a"], &["--out", "sub/../a"]] {
        let said = submit_two(&case, run);
        assert!(
            said.contains("are in the queue") && !said.contains("submitted"),
            "{said}"
        );
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
        for said in ["submitted 2 of 2 shards", "are in the queue"] {
            let arguments = ["slurm", study, "--array", "2", "--out", "50%j"];
            let path = format!("{}:/usr/bin:/bin", case.path("bin").display());
            let output = case.command(&arguments).env("PATH", path).output().unwrap();
            let found = String::from_utf8(output.stdout).unwrap();
            let error = String::from_utf8_lossy(&output.stderr);
            assert!(found.contains(said), "{study:?}: {found}{error}");
        }
    }
    let outputs = fs::read_to_string(case.path("outputs")).unwrap();
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
    let lines = text.lines().skip(1).map(|line| {
        let (_, json) = line.split_once(' ').unwrap();
        let json: serde_json::Value = serde_json::from_str(json).unwrap();
        (
            json["key"].as_str().unwrap().to_owned(),
            json["record"].clone(),
        )
    });
    lines.collect()
}

/// Writes journals of shards: for each record of a whole run, whether each of two shards has it and whether it failed there.
fn write_shards(case: &Case, folder: &str, shards: impl Fn(usize) -> [Option<bool>; 2]) {
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
        for (journal, state) in journals.iter().zip(shards(number)) {
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
    let case = Case::new();
    case.file("study.toml", SMALL);
    case.succeeds(&["run", "study.toml", "--out", "whole"]);
    let n = records(&case.path("whole/journal.jsonl")).len();
    assert!(n >= 2, "{n} work items");
    type Shards = fn(usize) -> [Option<bool>; 2];
    let cases: [(&str, Shards); 4] = [
        ("first", |number| {
            [Some(number == 0), (number == 0).then_some(false)]
        }),
        ("second", |number| {
            [Some(false), (number == 0).then_some(true)]
        }),
        ("both", |number| {
            [Some(number == 0), (number == 0).then_some(true)]
        }),
        ("all", |_| [Some(true), None]),
    ];
    for (folder, shards) in cases {
        write_shards(&case, folder, shards);
        let (_, said) = case.succeeds(&["merge", "study.toml", "--out", folder]);
        for table in ["accuracy.csv", "summary.csv", "failures.csv"] {
            let read = |folder: &str| fs::read(case.path(folder).join(table)).unwrap();
            assert!(read("whole") == read(folder), "{folder}, {table}: {said}");
        }
    }
}

#[test]
fn a_shard_with_a_failed_work_item_is_submitted_again() {
    let case = Case::new();
    fake_slurm(&case);
    case.file("study.toml", SMALL);
    case.succeeds(&["run", "study.toml", "--out", "whole"]);
    write_shards(&case, "failed", |_| [Some(true), Some(false)]);
    let said = submit_two(&case, &["--out", "failed"]);
    says(&said, &["submitted 1 of 2 shards"]);
    write_shards(&case, "done", |_| [Some(false), Some(false)]);
    let said = submit_two(&case, &["--out", "done"]);
    says(&said, &["all 2 shards are done"]);
}
