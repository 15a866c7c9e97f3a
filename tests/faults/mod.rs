//! What can happen to a run, and what its journal says afterwards.
// Each test file uses its part of this.
#![allow(dead_code)]

use crate::command::Case;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

/// Starts the command and goes on.
pub fn start(case: &Case, arguments: &[&str]) -> Child {
    let mut command = case.command(arguments);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

/// Sends a started command a signal, by its name.
pub fn signal(run: &Child, name: &str) {
    let id = run.id().to_string();
    let sent = Command::new("kill").args(["-s", name, &id]).status();
    assert!(sent.unwrap().success());
}

/// Runs the command where no file may grow beyond so many kilobytes, and who tries is told rather than killed.
pub fn full_disk(case: &Case, kilobytes: u32, arguments: &[&str]) -> Output {
    let script = format!(
        "ulimit -f {kilobytes}; trap '' XFSZ; exec {} {}",
        env!("CARGO_BIN_EXE_bubbletouch"),
        arguments.join(" ")
    );
    let mut bash = Command::new("bash");
    let bash = bash.args(["-c", &script]).current_dir(case.folder());
    bash.output().unwrap()
}

/// Keys of a journal in their order; of an unfinished last line nothing.
pub fn keys(journal: &Path) -> Vec<String> {
    let text = fs::read_to_string(journal).unwrap_or_default();
    let whole = text
        .split_inclusive('\n')
        .filter(|line| line.ends_with('\n'));
    let key = |line: &str| {
        let value: serde_json::Value =
            serde_json::from_str(line.split_once(' ').unwrap().1).unwrap();
        value["key"].as_str().unwrap().to_owned()
    };
    whole.map(key).collect()
}

/// What a command said on standard error.
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// SHA-256 of some bytes in hexadecimal digits.
pub fn sha256(bytes: &[u8]) -> String {
    use sha2::{Digest, Sha256};
    let digest = Sha256::digest(bytes);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Names of the pieces that a journal holds, as often as it does.
pub fn pieces(journal: &Path) -> Vec<String> {
    let keys = keys(journal).into_iter();
    keys.filter(|key| key.starts_with("piece ")).collect()
}
