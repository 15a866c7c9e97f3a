//! The corpus of refusals, `tests/refusals/*.toml`: what the program says of input that it does not accept.
//!
//! A case changes a base, `tests/fixtures/BASE.toml`, or has a text of its own, and states the error; ` … ` stands for any words. A case without an error is
//! accepted. A base with `[[patches]]` is a scene, every other base is a study. Both are read in this process, unless the case has a command, which exits
//! with code 2 if no other code is stated.

use crate::command::{Case, contains, fails, failures_of};
use crate::predictions::with_wrong_splits;
use crate::recorded::arrays::wrong_arrays;
use crate::recorded::law::with_shear;
use crate::recorded::sensors::contradictory;
use crate::recorded::simulated::small;
use crate::recorded::values::with_values;
use bubbletouch::kinds::{Source, load};
use bubbletouch::scene::ScenePlan;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Content of each file in the folder of a case; `@PATH` stands for a file of the repository.
type Files = BTreeMap<String, String>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Corpus {
    /// Base of the cases that name none.
    base: Option<String>,
    /// Module that writes the folder of each case.
    #[serde(default)]
    folder: String,
    /// Files of all cases.
    #[serde(default)]
    files: Files,
    case: Vec<Refusal>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Refusal {
    base: Option<String>,
    /// Pairs of a text that occurs once in the base, and its replacement.
    #[serde(default)]
    change: Vec<[String; 2]>,
    text: Option<String>,
    command: Option<String>,
    #[serde(default)]
    files: Files,
    #[serde(skip)]
    folder: String,
    code: Option<i32>,
    error: Option<String>,
}

/// Path of a file in the repository.
fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

impl Refusal {
    /// Returns the text of the study or scene; empty if the case has only a command.
    fn text(&self) -> String {
        let Some(base) = &self.base else {
            return self.text.clone().unwrap_or_default();
        };
        let base = fs::read_to_string(repository(&format!("tests/fixtures/{base}.toml")));
        self.change.iter().fold(base.unwrap(), |text, [old, new]| {
            assert_eq!(text.matches(old).count(), 1, "{old:?} in\n{text}");
            text.replacen(old, new, 1)
        })
    }

    /// Returns what the program says of the case.
    fn said(&self) -> Option<String> {
        let case = match &self.folder[..] {
            "predictions" => with_wrong_splits(),
            "recorded_arrays" => wrong_arrays(),
            "recorded_sensors" => contradictory(),
            "recorded_shear" => with_shear(),
            "recorded_small" => small(),
            "recorded_values" => with_values(),
            _ => Case::new(),
        };
        for (name, content) in &self.files {
            let path = case.path(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            match content.strip_prefix('@') {
                Some(source) => fs::copy(repository(source), path).map(drop).unwrap(),
                None => fs::write(path, content).unwrap(),
            }
        }
        let text = self.text();
        let is_scene = text.contains("[[patches]]");
        let name = if is_scene { "scene.toml" } else { "study.toml" };
        if !text.is_empty() {
            case.file(name, &text);
        }
        let said = match &self.command {
            Some(command) => self.answer(&case, command),
            None if is_scene => ScenePlan::read(&case.path(name))
                .err()
                .map(|e| e.to_string()),
            None => planned(case.folder(), &text).err().map(|e| e.to_string()),
        };
        let folder = format!("{}/", case.folder().display());
        said.map(|said| said.replace(&folder, ""))
    }

    /// Returns the error of a command; asserts its exit code, that it is one sentence, and that nothing is written.
    fn answer(&self, case: &Case, command: &str) -> Option<String> {
        let before = case.names();
        let output = case.run(command);
        if output.status.success() {
            return None;
        }
        let said = fails(&output, self.code.unwrap_or(2));
        assert_eq!(case.names(), before, "{said}");
        Some(said)
    }
}

/// Reads, loads and plans a study, as `bubbletouch plan` does.
fn planned(folder: &Path, text: &str) -> bubbletouch::Result<()> {
    let study = load(&Source {
        folder: folder.to_owned(),
        results: folder.join("results"),
        ..Source::of_text("study.toml", text)
    })?;
    study.plan().map(drop)
}

/// Returns the cases of all files, each with its name.
fn cases() -> Vec<(String, Refusal)> {
    let mut all = Vec::new();
    for file in fs::read_dir(repository("tests/refusals")).unwrap() {
        let path = file.unwrap().path();
        let name = path.file_stem().unwrap().display().to_string();
        let corpus = toml::from_str(&fs::read_to_string(&path).unwrap());
        let corpus: Corpus = corpus.unwrap_or_else(|error| panic!("{name}: {error}"));
        for (number, mut case) in (1..).zip(corpus.case) {
            if case.text.is_none() && case.base.is_none() {
                case.base.clone_from(&corpus.base);
            }
            case.files.extend(corpus.files.clone());
            case.folder.clone_from(&corpus.folder);
            all.push((format!("{name} {number}"), case));
        }
    }
    all
}

#[test]
fn every_case_of_the_corpus_is_refused_in_its_words_or_accepted() {
    let cases = cases();
    assert!(cases.len() > 300, "{} cases", cases.len());
    let failures = failures_of(&cases, |(name, case)| {
        let (said, wanted) = (case.said(), case.error.as_deref());
        let is_right = match (&said, wanted) {
            (Some(said), Some(wanted)) => contains(said, wanted),
            (said, wanted) => said.is_none() && wanted.is_none(),
        };
        assert!(is_right, "{name}\n wanted {wanted:?}\n    got {said:?}");
    });
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
