//! No command overwrites a file that it reads, or a file in an output folder that it did not write.

use crate::command::{Case, says, words};
use ndarray::{Array1, Array3};
use ndarray_npy::write_npy;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

const STUDY: &str = include_str!("../fixtures/texts/outputs.toml");

const RECORDED: &str = include_str!("../fixtures/texts/outputs_recorded.toml");

const SCENE: &str = include_str!("../fixtures/texts/outputs_scene_2.toml");

/// Returns all files below a folder with their bytes; links are followed.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match fs::read_link(&path) {
            Ok(target) => {
                all.insert(path, target.into_os_string().into_encoded_bytes());
            }
            Err(_) if path.is_dir() => {
                all.insert(path.clone(), Vec::new());
                all.extend(files(&path));
            }
            Err(_) => {
                all.insert(path.clone(), fs::read(&path).unwrap());
            }
        }
    }
    all
}

/// Runs a command; asserts that it is refused with the name of the file, and changes nothing.
fn refused(case: &Case, arguments: &[&str], file: &str) {
    let before = files(case.folder());
    let error = case.refuses(arguments);
    assert!(error.contains(file), "{arguments:?}: {error}");
    let after = files(case.folder());
    let names = |all: &BTreeMap<PathBuf, Vec<u8>>| all.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&before), names(&after), "{arguments:?}: {error}");
    for (path, bytes) in &before {
        assert!(
            *bytes == after[path],
            "{arguments:?} changed {}",
            path.display()
        );
    }
}

fn with_study() -> Case {
    let case = Case::new();
    case.file("study.toml", STUDY);
    case
}

fn with_recorded() -> Case {
    let case = Case::new();
    case.file("study.toml", RECORDED);
    let frames = Array3::from_shape_fn((40, 4, 4), |(n, y, x)| {
        ((n % 2) * (x + 2 * y) + n * 7 % 5) as f64 / 10.0
    });
    write_npy(case.path("frames.npy"), &frames).unwrap();
    let labels: Array1<i64> = (0..40).map(|n| n % 2).collect();
    write_npy(case.path("labels.npy"), &labels).unwrap();
    case
}

#[test]
fn a_study_is_not_replaced_by_its_results() {
    let case = with_study();
    refused(&case, &["run", "study.toml", "--out", "."], "study.toml");
    refused(
        &case,
        &["run", "study.toml", "--out", ".", "--fresh"],
        "study.toml",
    );
    refused(
        &case,
        &["run", "study.toml", "--out", ".", "--shard", "1/2"],
        "study.toml",
    );
    refused(&case, &["merge", "study.toml", "--out", "."], "study.toml");
    refused(
        &case,
        &["slurm", "study.toml", "--out", ".", "--array", "2"],
        "study.toml",
    );
    let whole = case.folder().display().to_string();
    refused(
        &case,
        &["run", "study.toml", "--out", &whole, "--fresh"],
        "study.toml",
    );
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(case.folder(), case.path("link")).unwrap();
        refused(&case, &["run", "study.toml", "--out", "link"], "study.toml");
        fs::create_dir(case.path("other")).unwrap();
        fs::hard_link(case.path("study.toml"), case.path("other/study.toml")).unwrap();
        refused(
            &case,
            &["run", "study.toml", "--out", "other"],
            "study.toml",
        );
    }
}

#[test]
fn a_run_refuses_each_file_of_somebody_else_that_it_would_write() {
    let case = with_study();
    fs::create_dir(case.path("found")).unwrap();
    let names = words(
        "summary.csv accuracy.csv limits.csv failures.csv variance.csv report.html study.toml manifest.json journal.jsonl confusion.svg accuracy_by_ratio.png",
    );
    for name in names {
        let path = case.file(&format!("found/{name}"), "a user's own\n");
        refused(&case, &["run", "study.toml", "--out", "found"], name);
        fs::remove_file(path).unwrap();
    }
    case.file("found/journal.jsonl", "no end of line");
    refused(
        &case,
        &["run", "study.toml", "--out", "found"],
        "journal.jsonl",
    );
    fs::remove_file(case.path("found/journal.jsonl")).unwrap();
    // Files that no run writes stay and have no effect.
    let own = [("found/notes.txt", "notes"), ("found/paper.csv", "a,b\n")];
    for (name, text) in own {
        case.file(name, text);
    }
    case.succeeds(&["run", "study.toml", "--out", "found"]);
    for (name, text) in own {
        assert_eq!(fs::read_to_string(case.path(name)).unwrap(), text);
    }
}

#[test]
fn a_folder_of_results_takes_its_study_again() {
    let case = with_study();
    let run = ["run", "study.toml", "--out", "found"];
    case.succeeds(&run);
    let first = fs::read(case.path("found/summary.csv")).unwrap();
    case.succeeds(&run);
    case.succeeds(&["report", "found"]);
    case.succeeds(&["report", "found", "--all-charts"]);
    case.succeeds(&["verify", "found", "--configurations", "1000"]);
    case.succeeds(&run);
    assert!(fs::read(case.path("found/summary.csv")).unwrap() == first);
    let (_, said) = case.succeeds(&["run", "study.toml", "--out", "found", "--fresh"]);
    says(&said, &["found.1"]);
    assert!(fs::read(case.path("found/summary.csv")).unwrap() == first);
    // Folder of an earlier version, whose manifest lists only tables.
    let manifest = case.path("found/manifest.json");
    let text = fs::read_to_string(&manifest).unwrap();
    let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
    json.as_object_mut()
        .unwrap()
        .remove("files_sha256")
        .unwrap();
    fs::write(&manifest, json.to_string()).unwrap();
    case.succeeds(&["report", "found"]);
    fs::write(&manifest, json.to_string()).unwrap();
    case.succeeds(&run);
    // Without a manifest, the owner of the files is unknown, but a page can be made.
    fs::remove_file(&manifest).unwrap();
    refused(&case, &run, "study.toml");
    let page = case.path("found/report.html");
    let written = fs::read(&page).unwrap();
    fs::write(&page, "<html>a user's own</html>").unwrap();
    refused(&case, &["report", "found"], "report.html");
    fs::write(&page, written).unwrap();
    case.succeeds(&["report", "found"]);
    case.succeeds(&["report", "found"]);
}

#[test]
fn a_fresh_run_renames_only_folders_of_results() {
    let case = with_study();
    fs::create_dir(case.path("own")).unwrap();
    case.file("own/thesis.tex", "years of work");
    refused(
        &case,
        &["run", "study.toml", "--out", "own", "--fresh"],
        "own",
    );
    #[cfg(unix)]
    {
        case.succeeds(&["run", "study.toml", "--out", "far"]);
        std::os::unix::fs::symlink(case.path("far"), case.path("near")).unwrap();
        case.succeeds(&["run", "study.toml", "--out", "near", "--fresh"]);
        assert!(fs::read_link(case.path("near")).is_ok());
        assert!(case.path("far.1/summary.csv").exists() && case.path("far/summary.csv").exists());
    }
}

#[test]
fn every_edit_of_a_folder_of_results_is_noticed_and_its_file_named() {
    let case = with_study();
    case.succeeds(&["run", "study.toml", "--out", "found"]);
    let mut names: Vec<String> = fs::read_dir(case.path("found"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.retain(|name| name != "manifest.json" && name != "journal.jsonl");
    names.sort();
    assert!(names.len() > 12, "{names:?}");
    for name in &names {
        let path = case.path("found").join(name);
        let bytes = fs::read(&path).unwrap();
        let mut edited = bytes.clone();
        let middle = bytes.len() / 2;
        edited[middle] ^= 1;
        let longer = [&bytes[..], b"\n1,2,3\n"].concat();
        for damaged in [edited, longer, bytes[..middle].to_vec()] {
            fs::write(&path, damaged).unwrap();
            let error = case.refuses(&["verify", "found", "--configurations", "1"]);
            assert!(error.contains(&format!("found/{name}")), "{name}: {error}");
        }
        fs::write(&path, bytes).unwrap();
    }
    case.succeeds(&["verify", "found"]);
}

#[test]
fn edits_that_the_manifest_hides_are_noticed_when_all_work_runs_again() {
    let case = with_study();
    case.succeeds(&["run", "study.toml", "--out", "found"]);
    let manifest = fs::read_to_string(case.path("found/manifest.json")).unwrap();
    for name in ["accuracy.csv", "summary.csv", "confusion.csv"] {
        let path = case.path("found").join(name);
        let table = fs::read_to_string(&path).unwrap();
        let last = table.lines().last().unwrap();
        let edited = format!("{table}{last}\n");
        let [from, to] = [&table, &edited].map(bubbletouch::study::sha256);
        fs::write(&path, &edited).unwrap();
        let hidden = manifest.replace(&from, &to);
        assert_ne!(hidden, manifest);
        fs::write(case.path("found/manifest.json"), hidden).unwrap();
        let error = case.refuses(&["verify", "found", "--configurations", "1000"]);
        assert!(error.contains(&format!("found/{name}")), "{name}: {error}");
        fs::write(&path, &table).unwrap();
        fs::write(case.path("found/manifest.json"), &manifest).unwrap();
    }
}

#[test]
fn data_folders_take_no_files_of_others() {
    let case = with_recorded();
    refused(
        &case,
        &["features", "study.toml", "--out", "."],
        "labels.npy",
    );
    let case = with_study();
    for command in ["touches", "features"] {
        let run = [command, "study.toml", "--out", command];
        case.succeeds(&run);
        case.succeeds(&run);
        fs::create_dir(case.path("own")).unwrap();
        case.file("own/objects.csv", "a user's own");
        refused(
            &case,
            &[command, "study.toml", "--out", "own"],
            "objects.csv",
        );
        fs::remove_dir_all(case.path("own")).unwrap();
    }
    refused(
        &case,
        &["features", "study.toml", "--out", "touches"],
        "touches",
    );
    refused(&case, &["run", "study.toml", "--out", "touches"], "touches");
    case.succeeds(&["run", "study.toml", "--out", "found"]);
    refused(&case, &["touches", "study.toml", "--out", "found"], "found");
    let one = ["press", "--object", "mug", "--out", "found/summary.csv"];
    refused(&case, &one, "summary.csv");
    let several = STUDY.replace("pitch_mm = 8.0", "pitch_mm = [8.0, 16.0]");
    case.file("several.toml", several);
    fs::create_dir_all(case.path("two/4x4_at_16_mm")).unwrap();
    case.file("two/4x4_at_16_mm/frames.npy", "a user's own");
    refused(
        &case,
        &["touches", "several.toml", "--out", "two"],
        "frames.npy",
    );
}

#[test]
fn a_scene_is_not_replaced_by_its_results() {
    let case = Case::new();
    case.file("scene.toml", SCENE);
    refused(
        &case,
        &["simulate", "scene.toml", "--out", "."],
        "scene.toml",
    );
    case.succeeds(&["simulate", "scene.toml", "--out", "found"]);
    case.succeeds(&["simulate", "scene.toml", "--out", "found"]);
    refused(
        &case,
        &["simulate", "found/scene.toml", "--out", "found"],
        "scene.toml",
    );
    for name in [
        "recording.npz",
        "wrenches.csv",
        "scene.toml",
        "manifest.json",
    ] {
        fs::create_dir(case.path("own")).unwrap();
        case.file(&format!("own/{name}"), "a user's own");
        refused(&case, &["simulate", "scene.toml", "--out", "own"], name);
        fs::remove_dir_all(case.path("own")).unwrap();
    }
}

#[test]
fn a_single_output_is_no_input() {
    let case = Case::new();
    case.file("a.csv", "x,y,z,r\n0,0,0.004,0.005\n");
    let press = |out: &str| -> Vec<String> {
        ["press", "--spheres", "a.csv", "--out", out]
            .map(str::to_owned)
            .to_vec()
    };
    fs::create_dir(case.path("sub")).unwrap();
    let absolute = case.path("a.csv").display().to_string();
    for out in ["a.csv", "./a.csv", "sub/../a.csv", &absolute] {
        let line = press(out);
        let line: Vec<&str> = line.iter().map(String::as_str).collect();
        refused(&case, &line, "a.csv");
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("a.csv", case.path("link.csv")).unwrap();
        fs::hard_link(case.path("a.csv"), case.path("hard.csv")).unwrap();
        for out in ["link.csv", "hard.csv"] {
            let line = press(out);
            let line: Vec<&str> = line.iter().map(String::as_str).collect();
            refused(&case, &line, out);
        }
    }
    case.file("poses.csv", "x,y,z,qw,qx,qy,qz\n0,0,0,1,0,0,0\n");
    let poses = words("press --spheres a.csv --poses poses.csv --out a.npy");
    case.succeeds(&poses);
    // A file that is not an input is replaced.
    case.file("b.csv", "old");
    case.succeeds(&["press", "--spheres", "a.csv", "--out", "b.csv"]);
    assert_ne!(fs::read_to_string(case.path("b.csv")).unwrap(), "old");
    case.file("box.obj", box_obj());
    let pack = words("objects pack box.obj --surface-error-mm 4 --out box.csv");
    case.succeeds(&pack);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("box.obj", case.path("out.csv")).unwrap();
        let pack = words("objects pack box.obj --surface-error-mm 4 --out out.csv");
        refused(&case, &pack, "out.csv");
        std::os::unix::fs::symlink("a.csv", case.path("out.png")).unwrap();
        let show = words("objects show golf --spheres a.csv --out out.png");
        refused(&case, &show, "out.png");
        let case = with_recorded();
        std::os::unix::fs::symlink("frames.npy", case.path("signal.toml")).unwrap();
        let calibrate = ["calibrate", "frames.npy", "--output", "signal.toml"];
        refused(&case, &calibrate, "signal.toml");
    }
}

#[test]
fn comparisons_replace_neither_of_the_folders_nor_write_one_output_of_two() {
    let case = with_study();
    case.succeeds(&["run", "study.toml", "--out", "a"]);
    case.succeeds(&["run", "study.toml", "--out", "b", "--seed", "5"]);
    refused(
        &case,
        &["compare", "a", "b", "--out", "a/summary.csv"],
        "summary.csv",
    );
    refused(
        &case,
        &["compare", "a", "b", "--html", "b/report.html"],
        "report.html",
    );
    let both = words("compare a b --out new.csv --html b/report.html");
    refused(&case, &both, "report.html");
    case.succeeds(&["features", "study.toml", "--out", "rows"]);
    let predictions = words("classify rows --classifier linear_svm --predictions rows/labels.npy");
    refused(&case, &predictions, "labels.npy");
}

#[cfg(unix)]
#[test]
fn a_file_is_written_through_a_link() {
    let case = Case::new();
    case.file("a.csv", "x,y,z,r\n0,0,0.004,0.005\n");
    fs::create_dir(case.path("disk")).unwrap();
    for (link, target) in [
        ("x.csv", "disk/x.csv"),
        ("y.csv", "x.csv"),
        ("z.csv", "disk/new.csv"),
    ] {
        std::os::unix::fs::symlink(target, case.path(link)).unwrap();
    }
    case.file("disk/x.csv", "old");
    case.succeeds(&["press", "--spheres", "a.csv", "--out", "y.csv"]);
    assert!(fs::read_link(case.path("y.csv")).is_ok() && fs::read_link(case.path("x.csv")).is_ok());
    assert_ne!(fs::read_to_string(case.path("disk/x.csv")).unwrap(), "old");
    case.succeeds(&["press", "--spheres", "a.csv", "--out", "z.csv"]);
    assert!(fs::read_link(case.path("z.csv")).is_ok() && case.path("disk/new.csv").exists());
}

#[test]
fn manual_pages_of_others_stay() {
    let case = Case::new();
    case.succeeds(&["man", "--out", "man1"]);
    case.succeeds(&["man", "--out", "man1"]);
    case.file("man1/bubbletouch-run.1", ".TH other 1\n");
    refused(&case, &["man", "--out", "man1"], "bubbletouch-run.1");
}

/// Returns a cube of 20 mm.
fn box_obj() -> String {
    let mut text = String::new();
    for n in 0..8 {
        let at = |bit: usize| if n >> bit & 1 == 1 { 0.02 } else { 0.0 };
        text += &format!("v {} {} {}\n", at(0), at(1), at(2));
    }
    for face in [
        "1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6",
    ] {
        text += &format!("f {face}\n");
    }
    text
}
