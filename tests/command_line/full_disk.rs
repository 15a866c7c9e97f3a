//! A full disk gives one sentence and exit code 1, and leaves no partial files.

use crate::command::{Case, fails, says};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Small valid study.
const STUDY: &str = include_str!("../fixtures/texts/bad_input.toml");

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_the_worlds_fault_and_leaves_nothing() {
    let case = Case::new();
    std::os::unix::fs::symlink("/dev/full", case.path("full.csv")).unwrap();
    let output = case.run("press --object mug --out full.csv");
    says(&fails(&output, 1), &["full.csv", "No space left"]);
    case.file("study.toml", STUDY);
    let small = case.create_folder("small");
    let Some(_mount) = SmallDisk::mount(&small) else {
        writeln!(
            std::io::stderr(),
            "SKIPPED: no right to mount a small tmpfs here"
        )
        .expect("standard error takes a line");
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
