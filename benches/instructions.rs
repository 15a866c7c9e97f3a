//! Number of instructions per step of each hot path, counted by callgrind. The number does not depend on the load of the machine.
//!
//! `cargo bench --bench instructions` runs each path under `valgrind --tool=callgrind`, once with few and once with more steps, and prints the difference per
//! step. With `-- --write`, the table is also written to `results/whole_body/instructions.csv`. Valgrind emulates processors with AVX2 and without AVX-512.
//! Without valgrind, a note is printed and nothing is counted.

use bubbletouch::files::CsvFile;
use hot_paths::{Make, body_step, decision, sensing, sparse_press};
use serde::Serialize;
use std::path::Path;
use std::process::Command;

mod hot_paths;

const PATHS: [(&str, Make); 4] = [
    ("press", sparse_press),
    ("body", body_step),
    ("sense", sensing),
    ("decide", decision),
];

/// Numbers of steps of the shorter and the longer run.
const STEPS: [u64; 2] = [3, 13];

#[derive(Serialize)]
struct Row {
    path: String,
    instructions_per_step: u64,
}

/// Runs a path for the given number of steps.
fn walk(path: &str, n_steps: u64) -> String {
    let (_, make) = PATHS
        .into_iter()
        .find(|(name, _)| *name == path)
        .expect("a path of ours");
    let mut path = make();
    (0..n_steps).for_each(|_| (path.step)());
    path.name
}

/// Returns the number of instructions of a whole run under callgrind; `None` without valgrind.
fn count(path: &str, n_steps: u64) -> Option<u64> {
    let this = std::env::current_exe().ok()?;
    let mut command = Command::new("valgrind");
    command.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]);
    let output = command
        .arg(this)
        .args([path, &n_steps.to_string()])
        .output()
        .ok()?;
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let (_, number) = text.split_once("Collected : ")?;
    number.split_whitespace().next()?.parse().ok()
}

fn main() -> bubbletouch::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [path, n_steps] = &arguments[..]
        && let Ok(n_steps) = n_steps.parse()
    {
        walk(path, n_steps);
        return Ok(());
    }
    let has = |flag: &str| arguments.iter().any(|argument| argument == flag);
    let mut rows = Vec::new();
    for (path, _) in PATHS {
        let name = walk(path, 1);
        if has("--test") {
            continue;
        }
        let [few, many] = STEPS.map(|n_steps| count(path, n_steps));
        let (Some(few), Some(many)) = (few, many) else {
            println!("{name}: no valgrind, nothing counted");
            continue;
        };
        let row = Row {
            path: name,
            instructions_per_step: (many - few) / (STEPS[1] - STEPS[0]),
        };
        println!(
            "{:42} {:>12} instructions a step",
            row.path, row.instructions_per_step
        );
        rows.push(row);
    }
    if has("--write") && !rows.is_empty() {
        std::fs::create_dir_all("results/whole_body").expect("a folder for results");
        let mut file = CsvFile::create(Path::new("results/whole_body/instructions.csv"))?;
        for row in &rows {
            file.row(row)?;
        }
        file.commit()?;
    }
    Ok(())
}
