//! Each sensor error is described in one descriptor, so that code outside `signal/` also works with errors that are added later.

use bubbletouch::signal::SENSOR_ERRORS;
use std::fs;
use std::path::{Path, PathBuf};

/// Folders and files that may name single errors: the errors themselves, the estimators, one per kind of error, and the audit of recorded data.
const MAY_NAME: [&str; 3] = [
    "crates/bubbletouch-sim/src/signal",
    "crates/bubbletouch-sim/src/calibration",
    "src/audit",
];

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

/// Returns the names in a line of code that belong to single errors: enum variants, and literals with words and keys of study files.
fn names_in(line: &str) -> Vec<String> {
    let abouts = SENSOR_ERRORS.iter().map(|error| (error, error.about()));
    let names = abouts.flat_map(|(error, about)| {
        let keys = about.strengths.iter().map(|strength| strength.key);
        let literals = keys.chain([about.step]).map(|word| format!("\"{word}\""));
        literals.chain([format!("SensorError::{error:?}")])
    });
    names.filter(|name| line.contains(name)).collect()
}

#[test]
fn no_file_outside_of_signal_names_a_single_sensor_error() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for folder in [
        "src",
        "crates/bubbletouch-sim/src",
        "crates/bubbletouch-svm/src",
    ] {
        rust_files(&root.join(folder), &mut files);
    }
    assert!(files.len() > 300, "{} files", files.len());
    let mut n_in_signal = 0;
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        let code = code
            .lines()
            .filter(|line| !line.trim_start().starts_with("//"));
        let names: Vec<String> = code.flat_map(names_in).collect();
        if MAY_NAME
            .iter()
            .any(|folder| file.starts_with(root.join(folder)))
        {
            n_in_signal += names.len();
        } else {
            assert!(names.is_empty(), "{}: {names:?}", file.display());
        }
    }
    assert!(n_in_signal > SENSOR_ERRORS.len(), "the search finds names");
}
