//! Build script that determines the hash of the sources, their commit and the compiler, which are written to manifests.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    // The commit itself is not listed, because the program would then be rebuilt after each commit.
    for path in [
        "src",
        "crates",
        "objects",
        "experiments/quickstart.toml",
        "Cargo.toml",
        "Cargo.lock",
    ] {
        println!("cargo::rerun-if-changed={path}");
    }
    let mut files = Vec::new();
    for path in ["src", "crates", "objects", "Cargo.toml", "Cargo.lock"] {
        add_files(Path::new(path), &mut files);
    }
    files.sort();
    println!("cargo::rustc-env=BUBBLETOUCH_SOURCE={:032x}", hash(&files));
    println!("cargo::rustc-env=BUBBLETOUCH_COMMIT={}", commit());
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let rustc = answer(&rustc, &["--version"]).unwrap_or_else(|| "unknown".to_owned());
    println!("cargo::rustc-env=BUBBLETOUCH_RUSTC={rustc}");
    let target = std::env::var("TARGET").unwrap_or_default();
    println!("cargo::rustc-env=BUBBLETOUCH_TARGET={target}");
}

fn add_files(path: &Path, files: &mut Vec<PathBuf>) {
    if !path.is_dir() {
        files.extend(path.exists().then(|| path.to_owned()));
        return;
    }
    let Ok(entries) = fs::read_dir(path) else {
        return;
    };
    for entry in entries.flatten() {
        add_files(&entry.path(), files);
    }
}

/// Returns the 128-bit FNV-1a hash of all file names and contents. The hash distinguishes versions but is not secure against attacks.
fn hash(files: &[PathBuf]) -> u128 {
    let mut hash: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    let mut add = |bytes: &[u8]| {
        for &byte in bytes {
            hash =
                (hash ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
    };
    for file in files {
        add(file.to_string_lossy().as_bytes());
        add(&[0]);
        add(&fs::read(file).unwrap_or_default());
        add(&[0]);
    }
    hash
}

/// Returns the last commit, with `-changed` if the sources differ from it; `unknown` outside a repository.
fn commit() -> String {
    let Some(commit) = answer("git", &["rev-parse", "--short=12", "HEAD"]) else {
        return "unknown".to_owned();
    };
    let of_program = [
        "status",
        "--porcelain",
        "--",
        "src",
        "crates",
        "crates",
        "objects",
        "Cargo.toml",
        "Cargo.lock",
    ];
    match answer("git", &of_program).as_deref() {
        Some("") => commit,
        _ => format!("{commit}-changed"),
    }
}

fn answer(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let said = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| said.trim().to_owned())
}
