//! Sessions in a shell, `tests/sessions/*.txt`: commands, and what they print.
//!
//! | line | meaning |
//! |---|---|
//! | `# TITLE` | starts a session in an empty folder |
//! | `@ VALUES` | the session runs with each of these values in the places of `{}`; a value with spaces has quotes `'` |
//! | `$ COMMAND` | a command for `sh`; lines with `> ` continue it; `$R` is the repository, `$T` its `tests/fixtures/texts` |
//! | `[2]` | the command is refused: exit code 2, one error, and no file is created, changed or removed |
//! | `[CODE, …]` | the command ends with this code and one error, and may write files |
//! | `[silent]` | the command prints nothing |
//! | `! WORDS` | the output does not contain the words |
//! | `WORDS` | the output contains the words; ` … ` stands for any words |
#![cfg(unix)]

use crate::command::{Case, contains, fails, failures_of};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

/// Command with the lines that state its outcome.
#[derive(Clone)]
struct Step {
    command: String,
    expected: Vec<String>,
}

/// Steps of one session, in their order.
struct Session {
    title: String,
    steps: Vec<Step>,
}

/// Returns the parts of a text that are separated by spaces; spaces between quotes `'` belong to a part.
fn values(text: &str) -> Vec<String> {
    let mut is_quoted = false;
    let parts = text.split(|c: char| {
        is_quoted ^= c == '\'';
        c == ' ' && !is_quoted
    });
    parts
        .map(|part| part.trim_matches('\'').to_owned())
        .collect()
}

/// Returns the session of a text from its title to its last line, once for each of its values.
fn sessions_of(file: &str, text: &str) -> Vec<Session> {
    let (title, lines) = text.split_once('\n').unwrap();
    let (mut all, mut steps) = (vec![String::new()], Vec::<Step>::new());
    for line in lines.lines().filter(|line| !line.is_empty()) {
        if let Some(text) = line.strip_prefix("@ ") {
            all = values(text);
        } else if let Some(command) = line.strip_prefix("$ ") {
            steps.push(Step {
                command: command.to_owned(),
                expected: Vec::new(),
            });
        } else if let Some(more) = line.strip_prefix("> ") {
            steps.last_mut().unwrap().command += &format!("\n{more}");
        } else {
            steps.last_mut().unwrap().expected.push(line.to_owned());
        }
    }
    let with = |value: &String| Session {
        title: format!("{file}: {title} {value}"),
        steps: steps.iter().map(|step| step.with(value)).collect(),
    };
    all.iter().map(with).collect()
}

/// Reads the sessions of a file.
fn sessions(path: &Path) -> Vec<Session> {
    let name = path.file_stem().unwrap().to_str().unwrap();
    let text = format!("\n{}", fs::read_to_string(path).unwrap());
    let sessions = text.split("\n# ").skip(1);
    sessions.flat_map(|text| sessions_of(name, text)).collect()
}

/// Returns all files below a folder with their bytes; a link has the path to which it points.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if let Ok(target) = fs::read_link(&path) {
            all.insert(path, target.into_os_string().into_encoded_bytes());
        } else if path.is_dir() {
            all.extend(files(&path));
            all.insert(path, Vec::new());
        } else if path.is_file() {
            let bytes = fs::read(&path).unwrap();
            all.insert(path, bytes);
        }
    }
    all
}

impl Step {
    /// Returns the step with a value in the places of `{}`.
    fn with(&self, value: &str) -> Self {
        let expected = self.expected.iter();
        Self {
            command: self.command.replace("{}", value),
            expected: expected.map(|line| line.replace("{}", value)).collect(),
        }
    }

    fn run(&self, case: &Case) -> Output {
        let mut shell = case.shell(&self.command);
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        shell
            .env("R", root)
            .env("T", root.join("tests/fixtures/texts"));
        shell.output().unwrap()
    }

    /// Runs the command. Panics if its outcome is not the expected one.
    fn check(&self, case: &Case) {
        let is_refused = self.expected.iter().any(|line| line == "[2]");
        let before = is_refused.then(|| files(case.folder()));
        let output = self.run(case);
        let code = self.expected.iter().find_map(|line| {
            let code = line.strip_prefix('[')?.split([']', ',']).next()?;
            code.parse().ok()
        });
        match code {
            Some(code) => drop(fails(&output, code)),
            None => assert!(output.status.success(), "{output:?}"),
        }
        if let Some(before) = before {
            let after = files(case.folder());
            let changed = before
                .iter()
                .find(|(path, bytes)| after.get(*path) != Some(*bytes));
            assert!(changed.is_none(), "{:?} was changed", changed.unwrap().0);
            assert_eq!(before.len(), after.len(), "a refused command wrote files");
        }
        let said = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        let said = said.concat();
        for line in &self.expected {
            if line == "[silent]" {
                assert_eq!(said, "");
            } else if let Some(words) = line.strip_prefix("! ") {
                assert!(!said.contains(words), "{words:?} in {said}");
            } else if !line.starts_with('[') {
                assert!(contains(&said, line), "no {line:?} in {said}");
            }
        }
    }
}

#[test]
fn every_session_ends_as_written() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/sessions");
    let paths = fs::read_dir(folder).unwrap();
    let sessions = paths.flat_map(|path| sessions(&path.unwrap().path()));
    let mut all: Vec<Session> = sessions.collect();
    if let Ok(name) = std::env::var("SESSION") {
        all.retain(|session| session.title.contains(&name));
    }
    let failures = failures_of(&all, |session| {
        let case = Case::new();
        for step in &session.steps {
            let failures = failures_of(&[step], |step| step.check(&case));
            let place = format!("{}\n$ {}", session.title, step.command);
            assert!(failures.is_empty(), "{place}\n{failures:?}");
        }
    });
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
