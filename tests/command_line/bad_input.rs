//! Bad input to the real command gives one clear sentence and the right exit code, and leaves no partial files.

use crate::command::{Case, says};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Small valid study.
const STUDY: &str = include_str!("../fixtures/texts/bad_input.toml");

pub fn refused(output: &Output, code: i32, words: &[&str]) {
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{error}");
    let sentences: Vec<&str> = error.lines().filter(|l| l.starts_with("error:")).collect();
    assert_eq!(sentences.len(), 1, "one sentence: {error}");
    for word in words {
        assert!(error.contains(word), "no '{word}' in: {error}");
    }
    assert!(!error.contains("panicked"), "{error}");
}

#[test]
fn an_output_folder_that_is_a_file_is_refused_and_left_alone() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    case.file("taken", "precious");
    refused(
        &case.run(&["run", "study.toml", "--out", "taken"]),
        2,
        &["taken", "folder"],
    );
    refused(
        &case.run(&["run", "study.toml", "--out", "taken/below"]),
        2,
        &["taken"],
    );
    refused(
        &case.run(&["touches", "study.toml", "--out", "taken"]),
        2,
        &["taken", "folder"],
    );
    assert_eq!(fs::read_to_string(case.path("taken")).unwrap(), "precious");
}

#[test]
fn what_the_user_names_wrongly_is_refused_as_bad_input() {
    let case = Case::new();
    for folder in ["empty", "x.ply", "x.csv"] {
        fs::create_dir(case.path(folder)).unwrap();
    }
    case.file("file", "precious");
    let before = case.names();
    for (arguments, words) in [
        ("report empty", &["empty/study.toml", "is missing"][..]),
        ("compare empty empty", &["empty/study.toml", "is missing"]),
        ("compare nothere empty", &["nothere/study.toml"]),
        ("recording nothere.npz", &["nothere.npz", "is missing"]),
        ("press --mesh x.ply", &["x.ply: a folder"]),
        ("press --spheres x.csv", &["x.csv: a folder"]),
        ("objects mesh x.ply", &["x.ply: a folder"]),
        (
            "objects pack x.ply --surface-error-mm 1 --out o.csv",
            &["x.ply: a folder"],
        ),
        (
            "press --object mug --out no/x.csv",
            &["no/x.csv", "no folder no"],
        ),
        (
            "press --object mug --out file/x.csv",
            &["file/x.csv", "no folder file"],
        ),
        ("objects mug --out no/x.png", &["no/x.png", "no folder no"]),
        (
            "objects pack mug --surface-error-mm 1 --out no/x.csv",
            &["no/x.csv"],
        ),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        refused(&case.run(&arguments), 2, words);
    }
    assert_eq!(case.names(), before, "nothing is written");
}

#[test]
fn a_fresh_start_over_a_file_is_refused_and_leaves_it_where_it_is() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    case.file("taken", "precious");
    let output = case.run(&["run", "study.toml", "--out", "taken", "--fresh"]);
    refused(&output, 2, &["taken: a file", "a folder"]);
    assert_eq!(fs::read_to_string(case.path("taken")).unwrap(), "precious");
    assert_eq!(case.names(), ["study.toml", "taken"]);
}

#[test]
fn meshes_that_names_leave_out_are_counted() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    fs::create_dir(case.path("ten")).unwrap();
    for number in 0..10 {
        case.file(&format!("ten/{number}.ply"), "ply");
    }
    let output = case.run(&["run", "study.toml", "--objects", "ten"]);
    refused(&output, 2, &["ten: 10 meshes", "objects.names"]);
    fs::create_dir(case.path("none")).unwrap();
    let output = case.run(&["run", "study.toml", "--objects", "none"]);
    refused(&output, 2, &["none: no meshes"]);
}

#[test]
#[cfg(unix)]
fn a_pipe_among_meshes_is_refused_and_not_waited_for() {
    let case = Case::new();
    let names = "names = [\"mug\", \"banana\", \"scissors\"]\n";
    case.file(
        "study.toml",
        STUDY
            .replace(names, "")
            .replace("surface_error_mm = 1.0", ""),
    );
    fs::create_dir(case.path("meshes")).unwrap();
    let made = Command::new("mkfifo")
        .arg(case.path("meshes/a.ply"))
        .status();
    assert!(made.unwrap().success());
    for arguments in [
        &["run", "study.toml", "--objects", "meshes"][..],
        &["plan", "study.toml", "--objects", "meshes"],
        &["press", "--mesh", "meshes/a.ply"],
        &["objects", "mesh", "meshes/a.ply"],
    ] {
        let mut child = case
            .command(arguments)
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        for _ in 0..300 {
            if child.try_wait().unwrap().is_some() {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
        let is_waiting = child.try_wait().unwrap().is_none();
        child.kill().unwrap();
        assert!(!is_waiting, "{arguments:?} waits for the pipe");
        refused(
            &child.wait_with_output().unwrap(),
            2,
            &["meshes/a.ply", "a pipe"],
        );
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_the_worlds_fault_and_leaves_nothing() {
    let case = Case::new();
    std::os::unix::fs::symlink("/dev/full", case.path("full.csv")).unwrap();
    let output = case.run(&["press", "--object", "mug", "--out", "full.csv"]);
    refused(&output, 1, &["full.csv", "No space left"]);
    case.file("study.toml", STUDY);
    let small = case.path("small");
    fs::create_dir(&small).unwrap();
    let Some(_mount) = SmallDisk::mount(&small) else {
        writeln!(
            std::io::stderr(),
            "SKIPPED: no right to mount a small tmpfs here"
        )
        .expect("standard error takes a line");
        return;
    };
    let output = case.run(&["run", "study.toml", "--out", "small/results"]);
    refused(&output, 1, &["No space left"]);
    for entry in fs::read_dir(small.join("results")).unwrap() {
        let path = entry.unwrap().path();
        assert!(is_whole(&path), "{} is half-written", path.display());
    }
}

/// Returns whether a file is complete: a table ends with a line break, a picture with its end mark, a page with its closing tag.
fn is_whole(path: &Path) -> bool {
    let bytes = fs::read(path).unwrap();
    match path.extension().and_then(|e| e.to_str()) {
        Some("csv" | "toml") => bytes.ends_with(b"\n"),
        Some("json") => serde_json::from_slice::<serde_json::Value>(&bytes).is_ok(),
        // A journal grows; the next run removes an incomplete last line (tests/study_resume.rs).
        Some("jsonl") => true,
        Some("svg") => bytes.trim_ascii_end().ends_with(b"</svg>"),
        Some("html") => bytes.trim_ascii_end().ends_with(b"</html>"),
        Some("png") => bytes.windows(4).any(|w| w == b"IEND"),
        _ => false,
    }
}

/// File system of 16 KiB that is removed when dropped.
struct SmallDisk(PathBuf);

impl SmallDisk {
    fn mount(folder: &Path) -> Option<Self> {
        let status = Command::new("mount")
            .args(["-t", "tmpfs", "-o", "size=16k", "tmpfs"])
            .arg(folder)
            .output();
        status
            .is_ok_and(|output| output.status.success())
            .then(|| Self(folder.to_owned()))
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        // The folder is inside a temporary folder; a mount that remains is cleaned up with the machine.
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

#[test]
fn a_published_accuracy_is_shown_beside_ours_and_kept_in_a_table() {
    let case = Case::new();
    let published = "\n[report]\npublished = [{ claim = \"98 % at 16:1\", accuracy = 0.98, source = \"[CL]\", ratio = 16, noise = 0 }]\n";
    case.file("study.toml", STUDY.to_owned() + published);
    let (said, _) = case.succeeds(&["run", "study.toml"]);
    let row = said.lines().find(|line| line.starts_with("98 % at 16:1"));
    assert!(row.is_some_and(|row| row.contains("[CL]")), "{said}");
    let table = fs::read_to_string(case.path("results/study/published.csv")).unwrap();
    assert!(
        table.lines().count() == 2 && table.contains("98 % at 16:1,[CL],0.98,"),
        "{table}"
    );
    // The resolved study of the run can be run again.
    let again = fs::read_to_string(case.path("results/study/study.toml")).unwrap();
    case.file("again.toml", again);
    case.succeeds(&["plan", "again.toml"]);
}

#[test]
fn a_seed_of_the_command_line_is_one_that_a_file_may_have() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    let plan = |seed: u64| case.run(&["plan", "study.toml", "--seed", &seed.to_string()]);
    assert!(plan(i64::MAX as u64).status.success());
    let refused = plan(i64::MAX as u64 + 1);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8(refused.stderr).unwrap();
    says(&said, &["--seed: 9223372036854775808; a number below 2⁶³"]);
}
