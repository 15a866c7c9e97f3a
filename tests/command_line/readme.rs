//! What the README tells people to type works.
#![cfg(unix)]

use crate::command::Case;
use bubbletouch::study::{Plan, StudySpec};
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::Command;

/// The README, or `None` (said aloud) while there is none.
fn readme() -> Option<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    if !path.exists() {
        writeln!(std::io::stderr(), "SKIPPED: there is no README.md")
            .expect("standard error takes a line");
        return None;
    }
    Some(fs::read_to_string(path).unwrap())
}

/// The text of each block that is fenced as this language.
fn blocks(text: &str, language: &str) -> Vec<String> {
    let fence = format!("```{language}");
    let mut blocks = Vec::new();
    let mut open: Option<(bool, String)> = None;
    for line in text.lines().map(str::trim_end) {
        match open.take() {
            None if line.trim_start().starts_with("```") => {
                open = Some((line.trim_start() == fence, String::new()));
            }
            None => {}
            Some((is_wanted, block)) if line.trim_start() == "```" => {
                blocks.extend(is_wanted.then_some(block));
            }
            Some((is_wanted, block)) => open = Some((is_wanted, block + line + "\n")),
        }
    }
    assert!(open.is_none(), "a fence is not closed");
    blocks
}

/// The commands of a shell block that can run here: not the slow ones, nor those on a folder of meshes that people bring.
fn commands(block: &str) -> Vec<String> {
    block
        .replace("\\\n", " ")
        .lines()
        .map(|line| line.trim().trim_start_matches("$ "))
        .filter_map(|line| {
            let arguments = ["bubbletouch ", "cargo run --release -- "]
                .iter()
                .find_map(|start| line.strip_prefix(start))?;
            Some(format!("bubbletouch {arguments}"))
        })
        .filter(|line| !line.trim_end().ends_with("# slow"))
        .filter(|line| !line.contains("--objects") && !line.contains("--mesh"))
        .collect()
}

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let to = to.join(path.file_name().unwrap());
        match path.is_dir() {
            true => copy_folder(&path, &to),
            false => drop(fs::copy(&path, &to).unwrap()),
        }
    }
}

#[test]
fn every_command_in_the_readme_works() {
    let Some(text) = readme() else { return };
    let commands: Vec<String> = blocks(&text, "sh")
        .iter()
        .flat_map(|b| commands(b))
        .collect();
    assert!(
        !commands.is_empty(),
        "the README shows a command in a ```sh block"
    );
    let case = Case::new();
    for folder in ["experiments", "objects"] {
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        copy_folder(&from, &case.path(folder));
    }
    let binary = Path::new(env!("CARGO_BIN_EXE_bubbletouch"));
    let path = std::env::var("PATH").unwrap();
    let path = format!("{}:{path}", binary.parent().unwrap().display());
    for command in commands {
        // One after the other in one folder, as a reader would: a later one may read what an earlier one wrote.
        let output = Command::new("sh")
            .args(["-e", "-c", &command])
            .current_dir(case.folder())
            .env("PATH", &path)
            .output()
            .unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{command}\n{error}");
        println!("works: {command}");
    }
}

#[test]
fn every_study_in_the_readme_can_be_planned() {
    let Some(text) = readme() else { return };
    let studies = blocks(&text, "toml");
    assert!(
        !studies.is_empty(),
        "the README shows a study in a ```toml block"
    );
    for study in studies {
        let spec = StudySpec::parse("README.md", &study).unwrap();
        Plan::new("README.md", spec).unwrap();
    }
}

#[test]
fn commands_are_found_in_shell_blocks_only_and_slow_ones_are_left_out() {
    let text = "```sh\ngit clone x\nbubbletouch press --object mug \\\n  --depth-mm 2  # draws\n\
        bubbletouch run a.toml # slow\ncargo run --release -- objects\ncargo run --release\n\
        bubbletouch run b.toml --objects ycb\n```\n```text\nbubbletouch lies\n```\n```toml\na = 1\n```\n";
    let found: Vec<String> = blocks(text, "sh")
        .iter()
        .flat_map(|b| commands(b))
        .collect();
    assert_eq!(
        found,
        [
            "bubbletouch press --object mug    --depth-mm 2  # draws",
            "bubbletouch objects"
        ]
    );
    assert_eq!(blocks(text, "toml"), ["a = 1\n"]);
}
