//! Commands in the README and the guide work, and their links lead to existing files.
#![cfg(unix)]

use crate::command::{Case, skip};
use bubbletouch::study::{Plan, StudySpec};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Returns the README and the chapters of the guide by name, as (file, text).
pub(crate) fn documents() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let guide = fs::read_dir(root.join("guide")).unwrap();
    let mut paths: Vec<_> = guide.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.is_file());
    paths.sort();
    paths.insert(0, root.join("README.md"));
    let read = |path: &PathBuf| {
        let name = path.strip_prefix(root).unwrap().display().to_string();
        (name, fs::read_to_string(path).unwrap())
    };
    paths.iter().map(read).collect()
}

/// Returns the text of each code block of a language.
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

/// Returns the commands of a shell block that can run in the test, without slow commands and those that need the reader's meshes.
fn commands(block: &str) -> Vec<String> {
    let command = |line: &str| {
        let line = line.trim().trim_start_matches("$ ");
        let mut starts = ["bubbletouch ", "cargo run --release -- "].iter();
        let arguments = starts.find_map(|start| line.strip_prefix(start))?;
        let is_left_out =
            line.ends_with("# slow") || line.contains("--objects") || line.contains("--mesh");
        (!is_left_out).then(|| format!("bubbletouch {arguments}"))
    };
    let joined = block.replace("\\\n", " ");
    joined.lines().filter_map(command).collect()
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

/// Creates a folder with the files of a cloned repository. Studies have one trial of few touches and the quickstart reads no whole frames, because the commands
/// are tested, not the results.
fn cloned() -> Case {
    let case = Case::new();
    for folder in ["experiments", "objects"] {
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        copy_folder(&from, &case.path(folder));
    }
    let shorter = |line: &str| match line.split_once(" = ") {
        Some(("trials", _)) => "trials = 1\n".to_owned(),
        Some(("per_object", _)) => "per_object = 20\n".to_owned(),
        _ => line.replace("\"identity\", ", "") + "\n",
    };
    for name in ["experiments/quickstart.toml", "experiments/cans.toml"] {
        let study: String = case.read(name).lines().map(shorter).collect();
        case.file(name, study);
    }
    case
}

#[test]
fn every_command_in_the_readme_and_the_guide_works() {
    let mut n_commands = 0;
    for (document, text) in documents() {
        // The commands run one after the other in one folder, because later ones may read the output of earlier ones.
        let case = cloned();
        for command in blocks(&text, "sh").iter().flat_map(|b| commands(b)) {
            let output = case.shell(&command).output().unwrap();
            let error = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{document}: {command}\n{error}");
            println!("{document}: works: {command}");
            n_commands += 1;
        }
    }
    assert!(n_commands > 10, "{n_commands} commands in ```sh blocks");
}

#[test]
fn every_study_in_the_readme_and_the_guide_can_be_planned() {
    for name in ["README.md", "guide/study_file.md"] {
        let documents = documents();
        let (_, text) = documents.iter().find(|(n, _)| n == name).unwrap();
        let studies = blocks(text, "toml");
        assert!(!studies.is_empty(), "{name} shows no study");
        for study in studies {
            let spec = StudySpec::parse(name, &study).unwrap();
            Plan::new(name, spec).unwrap();
        }
    }
}

/// Iterates over the files to which a text's links and pictures point.
fn linked_files(text: &str) -> impl Iterator<Item = &str> {
    let targets = text.split("](").skip(1);
    let targets = targets.filter_map(|rest| rest.split_once(')').map(|(target, _)| target));
    let files = targets.filter(|t| !t.contains("://") && !t.contains("::") && !t.starts_with('#'));
    files.map(|target| target.split_once('#').map_or(target, |(file, _)| file))
}

#[test]
fn what_the_readme_and_the_guide_link_to_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (document, text) in documents() {
        let folder = root.join(&document);
        let folder = folder.parent().unwrap();
        for file in linked_files(&text) {
            assert!(folder.join(file).exists(), "{document}: {file}");
        }
    }
}

/// Text of a file, or of all Rust files of a folder and its subfolders.
fn sources(path: &Path) -> String {
    if path.is_file() {
        return fs::read_to_string(path).unwrap();
    }
    let entries = fs::read_dir(path).unwrap().map(|e| e.unwrap().path());
    let rust = entries.filter(|p| p.is_dir() || p.extension().is_some_and(|e| e == "rs"));
    rust.map(|path| sources(&path)).collect()
}

/// Texts in backticks that are not the text of a link.
fn code_words(text: &str) -> impl Iterator<Item = &str> {
    let parts = text.split('`').skip(1).step_by(2);
    parts.filter(move |word| !text.contains(&format!("[`{word}`]")))
}

#[test]
fn every_function_of_the_architecture_page_is_in_its_files() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = fs::read_to_string(root.join("guide/architecture.md")).unwrap();
    let mut n_functions = 0;
    let mut missing = Vec::new();
    let mut is_table = false;
    for line in page.lines() {
        let fields: Vec<&str> = line.split('|').map(str::trim).collect();
        match fields[..] {
            ["", _, "function", "file", ""] => is_table = true,
            ["", _, functions, files, ""] if is_table => {
                let files = linked_files(files).map(|file| sources(&root.join("guide").join(file)));
                let text: String = files.collect();
                for name in code_words(functions).flat_map(|name| name.split("::")) {
                    let name = name.trim_end_matches('!');
                    let mut items = "fn struct enum trait const type macro_rules!".split(' ');
                    let is_defined = |item: &str| {
                        let mut ends = " (<:\n;".chars();
                        ends.any(|end| text.contains(&format!("{item} {name}{end}")))
                    };
                    // A method's type may be defined beside it, in another file.
                    let mut uses = [format!("impl {name}"), format!("> {name}")].into_iter();
                    if !items.any(is_defined) && !uses.any(|used| text.contains(&used)) {
                        missing.push(format!("{name}: {files:?}", files = fields[3]));
                    }
                    n_functions += 1;
                }
            }
            _ => is_table = false,
        }
    }
    assert!(n_functions > 50, "{n_functions}");
    assert!(missing.is_empty(), "{missing:#?}");
}

/// Maximum size of the committed results, bytes.
const MAX_RESULTS_BYTES: u64 = 12_000_000;

/// The result folders contain tables and each chart once. Files that one command can make again are not committed.
#[test]
fn committed_results_are_small_and_every_picture_is_shown() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut git = Command::new("git");
    let git = git.args(["ls-files", "-z", "results"]).current_dir(root);
    let listed = git.output();
    let names = listed.map(|listed| String::from_utf8(listed.stdout).unwrap());
    let names = names.unwrap_or_default();
    if names.is_empty() {
        skip("the source is no git repository, or there is no git");
        return;
    }
    let names: Vec<&str> = names.split_terminator('\0').collect();
    let size = |name: &&str| fs::metadata(root.join(name)).map_or(0, |meta| meta.len());
    let n_bytes: u64 = names.iter().map(size).sum();
    assert!(n_bytes <= MAX_RESULTS_BYTES, "{n_bytes} bytes in results/");
    let mut shown: Vec<String> = Vec::new();
    for (document, text) in documents() {
        let up = if document.contains('/') { "../" } else { "" };
        let linked = linked_files(&text).filter_map(|target| target.strip_prefix(up));
        shown.extend(linked.map(str::to_owned));
    }
    let is_table = |name: &str| {
        let mut ends = [".csv", ".toml", ".json", ".md"].iter();
        ends.any(|end| name.ends_with(end))
    };
    for name in names {
        let is_shown = shown.iter().any(|shown| shown == name);
        assert!(is_table(name) || is_shown, "{name} is shown nowhere");
    }
}

#[test]
fn the_readme_fits_in_two_hundred_lines() {
    // Comments, which name the tables of printed numbers, are not shown.
    let mut is_comment = false;
    let documents = documents();
    let shown = documents[0].1.lines().filter(|line| {
        is_comment |= line.starts_with("<!--");
        let is_shown = !is_comment;
        is_comment &= !line.ends_with("-->");
        is_shown
    });
    let n_lines = shown.count();
    assert!(n_lines <= 200, "{n_lines} lines");
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
