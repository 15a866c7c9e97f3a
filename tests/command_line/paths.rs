//! Paths in a study file are relative to that file; paths in a resolved study are absolute.

use crate::command::{Case, says, words};
use ndarray::{Array1, Array3};
use ndarray_npy::write_npy;
use std::fs;
use std::path::Path;

const RECORDED: &str = include_str!("../fixtures/texts/paths_recorded.toml");

const OBJECTS: &str = include_str!("../fixtures/texts/paths_objects.toml");

const BALL: &str = include_str!("../fixtures/texts/paths_ball.toml");

const MESH: &str = "v 0 0 0\nv .04 0 0\nv 0 .04 0\nv 0 0 .04\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

/// Writes frames of two classes; `bias` changes the frames.
fn write_frames(folder: &Path, bias: usize) {
    fs::create_dir_all(folder).unwrap();
    let frames = Array3::from_shape_fn((40, 4, 4), |(n, y, x)| {
        ((n % 2) * (x + 2 * y) + (n + bias) * 7 % 5) as f64 / 10.0
    });
    write_npy(folder.join("frames.npy"), &frames).unwrap();
    let labels: Array1<i64> = (0..40).map(|n| n % 2).collect();
    write_npy(folder.join("labels.npy"), &labels).unwrap();
    let groups: Array1<i64> = (0..40).map(|n| n / 4).collect();
    write_npy(folder.join("groups.npy"), &groups).unwrap();
}

fn write_objects(folder: &Path) {
    fs::create_dir_all(folder.join("own/meshes")).unwrap();
    fs::write(folder.join("own/objects.toml"), BALL).unwrap();
    fs::write(folder.join("own/meshes/corner.obj"), MESH).unwrap();
}

/// Runs a study in a subfolder from another folder, and its resolved form from a third one.
fn runs_from_anywhere(case: &Case, keys: &[&str]) {
    let (_, said) = case.succeeds(&["run", "lab/study.toml", "--out", "found"]);
    assert!(!said.contains("relative to the current folder"), "{said}");
    let resolved = fs::read_to_string(case.path("found/study.toml")).unwrap();
    let lab = case.path("lab").canonicalize().unwrap();
    for key in keys {
        let expected = lab.join(key).display().to_string();
        assert!(resolved.contains(&expected), "{key}: {resolved}");
    }
    fs::create_dir_all(case.path("far/away")).unwrap();
    let again = case
        .command(&["run", "../../found/study.toml", "--out", "again"])
        .current_dir(case.path("far/away"))
        .output()
        .unwrap();
    assert!(
        again.status.success(),
        "{}",
        String::from_utf8_lossy(&again.stderr)
    );
    for table in ["accuracy.csv", "summary.csv"] {
        let [first, second] = ["found", "far/away/again"]
            .map(|folder| fs::read(case.path(folder).join(table)).unwrap());
        assert!(first == second, "{table}");
    }
    for folder in ["found", "far/away/again"] {
        case.succeeds(&["verify", folder]);
        case.succeeds(&["report", folder]);
    }
}

#[test]
fn recorded_frames_stand_beside_their_study() {
    let case = Case::new();
    fs::create_dir(case.path("lab")).unwrap();
    case.file("lab/study.toml", RECORDED);
    write_frames(&case.path("lab/data"), 0);
    runs_from_anywhere(
        &case,
        &["data/frames.npy", "data/labels.npy", "data/groups.npy"],
    );
    // Files beside the study have priority over files in the current folder.
    write_frames(&case.path("data"), 3);
    case.succeeds(&["run", "lab/study.toml", "--out", "still"]);
    let [first, second] =
        ["found", "still"].map(|folder| fs::read(case.path(folder).join("study.toml")).unwrap());
    assert!(first == second);
}

#[test]
fn objects_stand_beside_their_study() {
    let case = Case::new();
    fs::create_dir(case.path("lab")).unwrap();
    case.file("lab/study.toml", OBJECTS);
    write_objects(&case.path("lab"));
    runs_from_anywhere(&case, &["own/objects.toml", "own/meshes"]);
}

#[test]
fn a_path_that_exists_only_from_the_current_folder_works_with_a_note() {
    let case = Case::new();
    fs::create_dir(case.path("lab")).unwrap();
    case.file("lab/study.toml", RECORDED);
    write_frames(&case.path("data"), 0);
    let (_, said) = case.succeeds(&["run", "lab/study.toml", "--out", "found"]);
    says(
        &said,
        &["note: data/frames.npy is relative to the current folder"],
    );
    fs::write(case.path("lab/study.toml"), OBJECTS).unwrap();
    write_objects(case.folder());
    let (_, said) = case.succeeds(&["run", "lab/study.toml", "--out", "objects"]);
    says(
        &said,
        &["note: own/objects.toml is relative to the current folder"],
    );
}

#[test]
fn a_folder_that_is_asked_for_is_relative_to_the_current_one() {
    let case = Case::new();
    fs::create_dir(case.path("lab")).unwrap();
    case.file("lab/study.toml", RECORDED.replace("data/", ""));
    write_frames(&case.path("elsewhere"), 0);
    let (_, said) = case.succeeds(&words("run lab/study.toml --objects elsewhere --out found"));
    assert!(!said.contains("note"), "{said}");
}

#[test]
fn a_file_that_is_missing_is_looked_for_beside_the_study() {
    let case = Case::new();
    fs::create_dir(case.path("lab")).unwrap();
    case.file("lab/study.toml", RECORDED);
    let error = case.refuses(&["run", "lab/study.toml", "--out", "found"]);
    says(&error, &["lab/data/frames.npy"]);
}

#[test]
fn the_page_says_how_to_make_its_results_again() {
    let case = Case::new();
    fs::create_dir_all(case.path("my lab/data")).unwrap();
    case.file("my lab/it's study.toml", RECORDED);
    write_frames(&case.path("my lab/data"), 0);
    case.succeeds(&[
        "run",
        "my lab/it's study.toml",
        "--out",
        "my results/a $b",
        "--seed",
        "7",
    ]);
    let manifest = fs::read_to_string(case.path("my results/a $b/manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
    let command = manifest["command"].as_str().unwrap();
    let expected = r"bubbletouch run 'my lab/it'\''s study.toml' --seed 7 --out 'my results/a $b'";
    assert_eq!(command, expected);
    let page = fs::read_to_string(case.path("my results/a $b/report.html")).unwrap();
    assert!(
        page.contains("--out &#39;my results/a $b&#39;"),
        "the page has the command"
    );
}
