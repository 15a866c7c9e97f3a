//! Outputs that are closed or full: a command does its work, and a write that fails is one error with exit code 1 that leaves no partial file.
#![cfg(target_os = "linux")]

use crate::command::{Case, fails, says, skip};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Command lines of all subcommands that write to standard output; those whose results others read come first.
const SPEAKERS: [&str; 24] = [
    "run study.toml --out results/study --threads 2",
    "run study.toml --out results/json --json --threads 2",
    "features study.toml --out features",
    "simulate scene.toml --out scene",
    "--help",
    "--version",
    "help run",
    "objects --help",
    "objects",
    "objects pack golf --surface-error-mm 1 --out o.csv",
    "objects mesh corner.obj",
    "press --object golf",
    "press --object golf --poses poses.csv",
    "completions bash",
    "man",
    "man --out pages",
    "plan study.toml",
    "recording scene/recording.npz",
    "recording scene/recording.npz --frame 0",
    "verify results/study --work-items 1",
    "report results/study",
    "compare results/study results/study --html o.html",
    "classify features --classifier linear_svm",
    "advise results/study --accuracy 0.01",
];

/// Runs all these commands with a standard output; checks that they do their work.
fn outputs(stdout: impl Fn() -> Stdio, check: impl Fn(&str, Output)) {
    let study = include_str!("../fixtures/texts/shell_speaking.toml");
    let case = Case::with("study.toml", study);
    let scene = include_str!("../fixtures/texts/shell_speaking_2.toml");
    case.file("scene.toml", scene);
    case.file("poses.csv", "x,y,z,qw,qx,qy,qz\n0,0,0,1,0,0,0\n");
    case.file("corner.obj", include_str!("../fixtures/texts/corner.obj"));
    for line in SPEAKERS {
        check(line, case.command(line).stdout(stdout()).output().unwrap());
    }
    let names = case.names().join(" ");
    says(&names, &["features", "o.csv", "o.html", "results", "scene"]);
    for made in ["results/study/report.html", "results/json/report.html"] {
        assert!(case.path(made).exists(), "{made}");
    }
}

/// Returns the writing end of a pipe that has no reader.
fn closed_pipe() -> Stdio {
    std::io::pipe().unwrap().1.into()
}

#[test]
fn every_subcommand_does_its_work_and_ends_quietly_where_nobody_reads_what_it_says() {
    outputs(closed_pipe, |line, output| {
        assert!(output.status.success(), "{line}: {output:?}");
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(
            !said.contains("error:") && !said.contains("panicked"),
            "{line}: {said}"
        );
    });
}

#[test]
fn a_standard_output_that_is_full_is_an_error_after_the_work_is_done() {
    let full = || {
        fs::File::options()
            .write(true)
            .open("/dev/full")
            .unwrap()
            .into()
    };
    outputs(full, |line, output| {
        // This command prints only progress, so a full standard output has no effect.
        if line.starts_with("features") {
            assert!(output.status.success(), "{output:?}");
        } else {
            let sentence = "error: standard output: write failed: No space left on device";
            says(&fails(&output, 1), &[sentence]);
        }
    });
}

#[test]
fn notes_and_errors_that_nobody_reads_change_no_exit_code() {
    let case = Case::with(
        "study.toml",
        include_str!("../fixtures/texts/shell_speaking.toml"),
    );
    for (line, code) in [
        ("run study.toml --threads 2", 0),
        ("press --object golf", 0),
        ("press --object unicorn", 2),
        ("press --no-such-option", 2),
    ] {
        let mut command = case.command(line);
        let status = command.stdout(Stdio::null()).stderr(closed_pipe()).status();
        assert_eq!(status.unwrap().code(), Some(code), "{line}");
    }
    assert!(case.path("results/study/report.html").exists());
}

#[test]
fn a_full_disk_is_the_worlds_fault_and_leaves_nothing() {
    let case = Case::new();
    std::os::unix::fs::symlink("/dev/full", case.path("full.csv")).unwrap();
    let output = case.run("press --object mug --out full.csv");
    says(&fails(&output, 1), &["full.csv", "No space left"]);
    case.file(
        "study.toml",
        include_str!("../fixtures/texts/bad_input.toml"),
    );
    let small = case.create_folder("small");
    let Some(_mount) = SmallDisk::mount(&small) else {
        skip("no right to mount a small tmpfs here");
        return;
    };
    let output = case.run("run study.toml --out small/results");
    says(&fails(&output, 1), &["No space left"]);
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
