//! Bad input to the real command gives one clear sentence and the right exit code, and leaves no partial files.

use crate::command::Case;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Small valid study; each test changes one thing in it.
const STUDY: &str = r#"
question = "Does it work?"
trials = 2

[objects]
sets = ["household"]
names = ["mug", "banana", "scissors"]
surface_error_mm = 1.0

[skin]
pitch_mm = 4.0
size_mm = 64.0
stroke_mm = 5.0

[touches]
per_object = 8
offset_x_mm = { uniform = [-5.0, 5.0] }
depth_mm = 3.0

[sensing]
ratio = [4, 16]

[recognition]
classifier = "linear_svm"
"#;

impl Case {
    /// Runs the study with `old` replaced by `new`; asserts that the command refuses it with all of `words` and writes nothing.
    fn refuses(&self, old: &str, new: &str, words: &[&str]) {
        assert!(
            STUDY.contains(old),
            "the test replaces something that is there: {old}"
        );
        self.file("study.toml", STUDY.replace(old, new));
        refused(&self.run(&["run", "study.toml"]), 2, words);
        assert!(!self.path("results").exists(), "nothing is written");
    }

    /// Runs `press` with these arguments; asserts that the command refuses them and writes nothing.
    fn refuses_press(&self, arguments: &[&str], words: &[&str]) {
        let all = [&["press", "--out", "out.csv"], arguments].concat();
        refused(&self.run(&all), 2, words);
        assert!(!self.path("out.csv").exists(), "nothing is written");
    }
}

pub fn refused(output: &Output, code: i32, words: &[&str]) {
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{error}");
    let sentences: Vec<&str> = error.lines().filter(|l| l.starts_with("error:")).collect();
    assert_eq!(sentences.len(), 1, "one sentence: {error}");
    for word in words {
        assert!(error.contains(word), "no '{word}' in: {error}");
    }
    assert!(!error.contains("panicked"), "{error}");
}

#[test]
fn the_study_that_the_tests_break_runs() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    let output = case.run(&["run", "study.toml"]);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(case.path("results/study/accuracy.csv").exists());
}

#[test]
fn an_unknown_key_is_named_with_its_line() {
    Case::new().refuses(
        "stroke_mm",
        "strke_mm",
        &["study.toml:13", "strke_mm", "stroke_mm"],
    );
}

#[test]
fn a_wrong_type_is_named_with_its_line() {
    Case::new().refuses(
        "trials = 2",
        "trials = \"two\"",
        &["study.toml:3", "\"two\"", "whole number"],
    );
    Case::new().refuses(
        "depth_mm = 3.0",
        "depth_mm = \"deep\"",
        &["study.toml:18", "uniform"],
    );
}

#[test]
fn an_object_to_show_that_is_not_there_is_refused_before_the_study_runs() {
    Case::new().refuses(
        "[sensing]",
        "[report]\nsamples = [\"mug\", \"kettle\"]\n\n[sensing]",
        &["report.samples", "kettle", "mug, banana, scissors"],
    );
}

#[test]
fn a_file_that_is_not_toml_is_refused() {
    Case::new().refuses("[skin]", "[skin", &["study.toml:10"]);
}

#[test]
fn sizes_that_make_no_array_are_refused() {
    Case::new().refuses(
        "pitch_mm = 4.0",
        "pitch_mm = -4.0",
        &["skin.pitch_mm", "-4"],
    );
    Case::new().refuses(
        "pitch_mm = 4.0",
        "pitch_mm = nan",
        &["skin.pitch_mm", "NaN"],
    );
    Case::new().refuses(
        "size_mm = 64.0",
        "taxels = 0",
        &["skin.taxels", "at most 4096"],
    );
    Case::new().refuses(
        "size_mm = 64.0",
        "size_mm = 63.0",
        &["whole number of pitches"],
    );
    Case::new().refuses(
        "stroke_mm = 5.0",
        "stroke_mm = 0.0",
        &["skin.stroke_mm", "positive"],
    );
}

#[test]
fn too_few_objects_are_refused() {
    Case::new().refuses("sets = [\"household\"]", "sets = []", &["objects", "sets"]);
    let names = "[\"mug\", \"banana\", \"scissors\"]";
    Case::new().refuses(names, "[]", &["objects.names"]);
    Case::new().refuses(names, "[\"mug\"]", &["1 object", "at least two"]);
    Case::new().refuses(names, "[\"mug\", \"unicorn\"]", &["unicorn"]);
    Case::new().refuses("\"household\"", "\"zoo\"", &["zoo", "household"]);
}

#[test]
fn axes_out_of_range_are_refused() {
    Case::new().refuses("[4, 16]", "[4, 257]", &["sensing.ratio", "257", "256"]);
    Case::new().refuses("[4, 16]", "[0.5]", &["sensing.ratio", "at least 1"]);
    Case::new().refuses("[4, 16]", "[]", &["sensing.ratio", "empty"]);
    Case::new().refuses("[4, 16]", "[4, 4]", &["twice"]);
    Case::new().refuses("\"linear_svm\"", "\"oracle\"", &["oracle", "linear_svm"]);
    Case::new().refuses("trials = 2", "trials = 0", &["trials", "at least 1"]);
    Case::new().refuses("per_object = 8", "per_object = 1", &["row"]);
    Case::new().refuses("per_object = 8\n", "", &["per_object"]);
}

#[test]
fn a_study_that_is_not_there_is_refused() {
    let case = Case::new();
    refused(&case.run(&["run", "missing.toml"]), 2, &["missing.toml"]);
}

#[test]
fn an_output_folder_that_is_a_file_is_refused_and_left_alone() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    case.file("taken", "precious");
    refused(
        &case.run(&["run", "study.toml", "--out", "taken"]),
        2,
        &["taken", "folder"],
    );
    refused(
        &case.run(&["run", "study.toml", "--out", "taken/below"]),
        2,
        &["taken"],
    );
    refused(
        &case.run(&["touches", "study.toml", "--out", "taken"]),
        2,
        &["taken", "folder"],
    );
    assert_eq!(fs::read_to_string(case.path("taken")).unwrap(), "precious");
}

#[test]
fn what_the_user_names_wrongly_is_refused_as_bad_input() {
    let case = Case::new();
    for folder in ["empty", "x.ply", "x.csv"] {
        fs::create_dir(case.path(folder)).unwrap();
    }
    case.file("file", "precious");
    let before = case.names();
    for (arguments, words) in [
        ("report empty", &["empty/study.toml", "is missing"][..]),
        ("compare empty empty", &["empty/study.toml", "is missing"]),
        ("compare nothere empty", &["nothere/study.toml"]),
        ("recording nothere.npz", &["nothere.npz", "is missing"]),
        ("press --mesh x.ply", &["x.ply: a folder"]),
        ("press --spheres x.csv", &["x.csv: a folder"]),
        ("objects mesh x.ply", &["x.ply: a folder"]),
        (
            "objects pack x.ply --surface-error-mm 1 --out o.csv",
            &["x.ply: a folder"],
        ),
        (
            "press --object mug --out no/x.csv",
            &["no/x.csv", "no folder no"],
        ),
        (
            "press --object mug --out file/x.csv",
            &["file/x.csv", "no folder file"],
        ),
        ("objects mug --out no/x.png", &["no/x.png", "no folder no"]),
        (
            "objects pack mug --surface-error-mm 1 --out no/x.csv",
            &["no/x.csv"],
        ),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        refused(&case.run(&arguments), 2, words);
    }
    assert_eq!(case.names(), before, "nothing is written");
}

#[test]
fn a_fresh_start_over_a_file_is_refused_and_leaves_it_where_it_is() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    case.file("taken", "precious");
    let output = case.run(&["run", "study.toml", "--out", "taken", "--fresh"]);
    refused(&output, 2, &["taken: a file", "a folder"]);
    assert_eq!(fs::read_to_string(case.path("taken")).unwrap(), "precious");
    assert_eq!(case.names(), ["study.toml", "taken"]);
}

#[test]
fn meshes_that_names_leave_out_are_counted() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    fs::create_dir(case.path("ten")).unwrap();
    for number in 0..10 {
        case.file(&format!("ten/{number}.ply"), "ply");
    }
    let output = case.run(&["run", "study.toml", "--objects", "ten"]);
    refused(&output, 2, &["ten: 10 meshes", "objects.names"]);
    fs::create_dir(case.path("none")).unwrap();
    let output = case.run(&["run", "study.toml", "--objects", "none"]);
    refused(&output, 2, &["none: no meshes"]);
}

#[test]
#[cfg(unix)]
fn a_pipe_among_meshes_is_refused_and_not_waited_for() {
    let case = Case::new();
    let names = "names = [\"mug\", \"banana\", \"scissors\"]\n";
    case.file(
        "study.toml",
        STUDY
            .replace(names, "")
            .replace("surface_error_mm = 1.0", ""),
    );
    fs::create_dir(case.path("meshes")).unwrap();
    let made = Command::new("mkfifo")
        .arg(case.path("meshes/a.ply"))
        .status();
    assert!(made.unwrap().success());
    for arguments in [
        &["run", "study.toml", "--objects", "meshes"][..],
        &["plan", "study.toml", "--objects", "meshes"],
        &["press", "--mesh", "meshes/a.ply"],
        &["objects", "mesh", "meshes/a.ply"],
    ] {
        let mut child = case
            .command(arguments)
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        for _ in 0..300 {
            if child.try_wait().unwrap().is_some() {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
        let is_waiting = child.try_wait().unwrap().is_none();
        child.kill().unwrap();
        assert!(!is_waiting, "{arguments:?} waits for the pipe");
        refused(
            &child.wait_with_output().unwrap(),
            2,
            &["meshes/a.ply", "a pipe"],
        );
    }
}

#[test]
fn numbers_that_no_machine_has_room_for_are_refused_at_once() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    case.file("poses.csv", "x,y,z,qw,qx,qy,qz\n0,0,0,1,0,0,0\n");
    case.file("tetrahedron.obj", TETRAHEDRON);
    let start = std::time::Instant::now();
    for (arguments, words) in [
        (
            "run study.toml --threads 10000",
            &["--threads: 10000", "1 to "][..],
        ),
        ("run study.toml --threads 0", &["--threads: 0"]),
        (
            "slurm study.toml --array 99999999999",
            &["--array", "4000000"],
        ),
        (
            "press --object golf --poses poses.csv --repeat 99999999999",
            &["--repeat: 99999999999", "1000000"],
        ),
        (
            "objects pack mug --surface-error-mm 0.0001 --out o.csv",
            &["2000000 spheres", "larger"],
        ),
        (
            "objects pack tetrahedron.obj --surface-error-mm 0.0001 --out o.csv",
            &["1.000e-4 mm", "spheres for 236.6 cm²", "2000000 spheres"],
        ),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        refused(&case.run(&arguments), 2, words);
    }
    // A tolerance that needs few spheres is accepted, and the number of measured points is limited by memory.
    case.succeeds(&[
        "objects",
        "pack",
        "golf",
        "--surface-error-mm",
        "0.0001",
        "--out",
        "o.csv",
    ]);
    let took = start.elapsed().as_secs_f64();
    assert!(took < 60.0, "{took} s");
}

/// Corner of a cube of 0.1 m; its surface area is (3/2 + √3/2) 0.1² = 0.02366 m².
const TETRAHEDRON: &str =
    "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

#[test]
fn broken_meshes_are_refused() {
    let case = Case::new();
    let header = |n: usize| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex {n}\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
        )
    };
    case.refuses_press(&["--mesh", "missing.ply"], &["missing.ply"]);
    case.file("truncated.ply", header(3) + "0 0 0\n0 0 1\n");
    case.refuses_press(&["--mesh", "truncated.ply"], &["truncated.ply"]);
    case.file("nan.ply", header(2) + "0 0 0\n0 nan 1\n");
    case.refuses_press(&["--mesh", "nan.ply"], &["nan.ply"]);
    case.file("zero.ply", header(0));
    case.refuses_press(&["--mesh", "zero.ply"], &["zero.ply"]);
    case.file("text.ply", "this is not a mesh\n");
    case.refuses_press(&["--mesh", "text.ply"], &["text.ply"]);
    case.file("empty.ply", "");
    case.refuses_press(&["--mesh", "empty.ply"], &["empty.ply"]);
}

#[test]
fn broken_spheres_are_refused_with_their_line() {
    let case = Case::new();
    let good = "x,y,z,r\n0,0,0.01,0.02\n";
    for (name, line, word) in [
        ("nan", "0,nan,0,0.01", "nan"),
        ("negative", "0,0,0,-0.01", "-0.01"),
        ("zero", "0,0,0,0", "0"),
        ("short", "0,0,0", "4 columns"),
        ("text", "0,zero,0,0.01", "zero"),
    ] {
        let name = format!("spheres_{name}.csv");
        case.file(&name, format!("{good}{line}\n"));
        case.refuses_press(&["--spheres", &name], &[&name, "3", word]);
    }
    case.file("none.csv", "x,y,z,r\n");
    case.refuses_press(&["--spheres", "none.csv"], &["none.csv"]);
}

#[test]
fn press_options_out_of_range_are_refused() {
    let case = Case::new();
    let mug = ["--object", "mug"];
    let with = |more: &[&'static str]| [&mug, more].concat();
    case.refuses_press(&with(&["--taxels", "0x4"]), &["0x4"]);
    case.refuses_press(&with(&["--taxels", "many"]), &["many"]);
    case.refuses_press(&with(&["--pitch-mm", "-1"]), &["-1"]);
    case.refuses_press(&with(&["--pitch-mm", "nan"]), &["pitch"]);
    case.refuses_press(&with(&["--stroke-mm", "0"]), &["stroke"]);
    case.refuses_press(&with(&["--depth-mm", "0"]), &["--depth-mm"]);
    case.refuses_press(&with(&["--rest", "99"]), &["--rest", "99"]);
    case.refuses_press(&with(&["--offset-x-mm", "900"]), &["offset"]);
    case.refuses_press(&["--object", "unicorn"], &["unicorn"]);
    case.refuses_press(&["--object", "mug", "--mesh", "cup.ply"], &["--mesh"]);
    case.refuses_press(&[], &["--object"]);
    refused(
        &case.run(&["press", "--object", "mug", "--out", "map.jpeg"]),
        2,
        &["map.jpeg", ".png"],
    );
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_the_worlds_fault_and_leaves_nothing() {
    let case = Case::new();
    std::os::unix::fs::symlink("/dev/full", case.path("full.csv")).unwrap();
    let output = case.run(&["press", "--object", "mug", "--out", "full.csv"]);
    refused(&output, 1, &["full.csv", "No space left"]);
    case.file("study.toml", STUDY);
    let small = case.path("small");
    fs::create_dir(&small).unwrap();
    let Some(_mount) = SmallDisk::mount(&small) else {
        writeln!(
            std::io::stderr(),
            "SKIPPED: no right to mount a small tmpfs here"
        )
        .expect("standard error takes a line");
        return;
    };
    let output = case.run(&["run", "study.toml", "--out", "small/results"]);
    refused(&output, 1, &["No space left"]);
    for entry in fs::read_dir(small.join("results")).unwrap() {
        let path = entry.unwrap().path();
        assert!(is_whole(&path), "{} is half-written", path.display());
    }
}

/// Returns whether a file is complete: a table ends with a line break, a picture with its end mark, a page with its closing tag.
fn is_whole(path: &Path) -> bool {
    let bytes = fs::read(path).unwrap();
    match path.extension().and_then(|e| e.to_str()) {
        Some("csv" | "toml") => bytes.ends_with(b"\n"),
        Some("json") => serde_json::from_slice::<serde_json::Value>(&bytes).is_ok(),
        // A journal grows; the next run removes an incomplete last line (tests/study_resume.rs).
        Some("jsonl") => true,
        Some("svg") => bytes.trim_ascii_end().ends_with(b"</svg>"),
        Some("html") => bytes.trim_ascii_end().ends_with(b"</html>"),
        Some("png") => bytes.windows(4).any(|w| w == b"IEND"),
        _ => false,
    }
}

/// File system of 16 KiB that is removed when dropped.
struct SmallDisk(PathBuf);

impl SmallDisk {
    fn mount(folder: &Path) -> Option<Self> {
        let status = Command::new("mount")
            .args(["-t", "tmpfs", "-o", "size=16k", "tmpfs"])
            .arg(folder)
            .output();
        status
            .is_ok_and(|output| output.status.success())
            .then(|| Self(folder.to_owned()))
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        // The folder is inside a temporary folder; a mount that remains is cleaned up with the machine.
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

#[test]
fn keys_of_features_frames_and_fused_touches_are_checked() {
    let refuses = |section: &str, line: &str, words: &[&str]| {
        Case::new().refuses(section, &format!("{section}\n{line}"), words);
    };
    refuses("[touches]", "frames = 0", &["touches.frames", "at least 1"]);
    refuses("[touches]", "frames = [2, 2]", &["touches.frames", "twice"]);
    refuses(
        "[recognition]",
        "features = \"loud\"",
        &["study.toml:24", "loud", "unit_norm", "polar_harmonics"],
    );
    refuses(
        "[recognition]",
        "features = \"descriptors+raw\"",
        &["study.toml:24", "descriptors+raw", "joined by +"],
    );
    refuses(
        "[recognition]",
        "touches_per_decision = [1, 0]",
        &["recognition.touches_per_decision", "at least 1"],
    );
    // Two of eight touches are test touches.
    refuses(
        "[recognition]",
        "touches_per_decision = 3",
        &[
            "recognition.touches_per_decision",
            "at most 2",
            "test touches",
        ],
    );
}

#[test]
fn keys_of_a_choice_are_checked_and_none_is_silently_ignored() {
    let refuses = |line: &str, words: &[&str]| {
        Case::new().refuses("[recognition]", &format!("[recognition]\n{line}"), words);
    };
    refuses(
        "gamma_grid = [1.0]",
        &["gamma_grid", "no classifier", "rbf_svm"],
    );
    refuses("gamma = 1.0", &["recognition.gamma", "no classifier"]);
    refuses("cv_folds = 3", &["cv_folds", "c_grid"]);
    refuses("cv_touches = 3", &["cv_touches", "c_grid"]);
    refuses(
        "c_grid = [1.0, 2.0]\ncv_folds = 1",
        &["cv_folds", "at least 2"],
    );
    refuses(
        "c_grid = [1.0, 2.0]\ncv_folds = 7",
        &["cv_folds", "at most 6", "training touches"],
    );
    let rbf = |line: &str, words: &[&str]| {
        let old = "classifier = \"linear_svm\"";
        Case::new().refuses(old, &format!("classifier = \"rbf_svm\"\n{line}"), words);
    };
    rbf(
        "gamma = 1.0\ngamma_grid = [1.0]",
        &["both gamma and gamma_grid"],
    );
    rbf("gamma_grid = [1.0, -1.0]", &["gamma_grid", "-1", "above 0"]);
}

#[test]
fn keys_of_single_classifiers_are_checked_and_belong_to_one_of_the_study() {
    let refuses = |classifier: &str, line: &str, words: &[&str]| {
        let new = format!("classifier = \"{classifier}\"\n{line}");
        Case::new().refuses("classifier = \"linear_svm\"", &new, words);
    };
    refuses(
        "linear_svm",
        "n_trees = 10",
        &["recognition.n_trees", "no classifier", "random_forest"],
    );
    refuses(
        "k_nearest",
        "max_depth = 3",
        &["recognition.max_depth", "random_forest"],
    );
    refuses("decision_tree", "", &["exists no more", "random_forest"]);
    refuses(
        "k_nearest",
        "n_neighbours = 0",
        &["recognition.n_neighbours", "at least 1"],
    );
    refuses(
        "polynomial_svm",
        "degree = 21",
        &["recognition.degree", "at most 20"],
    );
    refuses(
        "polynomial_svm",
        "degree = 2.5",
        &["study.toml:", "2.5", "a whole number"],
    );
    refuses(
        "k_nearest",
        "n_neighbors = 3",
        &[
            "study.toml:",
            "`n_neighbors`",
            "`features`",
            "`n_neighbours`",
        ],
    );
}

#[test]
fn a_published_accuracy_about_no_cell_is_refused_before_the_study_runs() {
    let case = Case::new();
    let with = |keys: &str| {
        format!(
            "classifier = \"linear_svm\"\n[report]\npublished = [{{ claim = \"98 %\", accuracy = 0.98, source = \"[CL]\", {keys} }}]"
        )
    };
    for (keys, words) in [
        ("ratio = 64", ["claim '98 %', ratio", "one of 4, 16"]),
        ("kernel = \"rbf\"", ["kernel: is no setting", "classifier"]),
        ("classifier = \"rbf_svm\"", ["rbf_svm", "linear_svm"]),
    ] {
        case.refuses("classifier = \"linear_svm\"", &with(keys), &words);
    }
}

#[test]
fn a_published_accuracy_is_shown_beside_ours_and_kept_in_a_table() {
    let case = Case::new();
    let published = "\n[report]\npublished = [{ claim = \"98 % at 16:1\", accuracy = 0.98, source = \"[CL]\", ratio = 16, noise = 0 }]\n";
    case.file("study.toml", STUDY.to_owned() + published);
    let (said, _) = case.succeeds(&["run", "study.toml"]);
    let row = said.lines().find(|line| line.starts_with("98 % at 16:1"));
    assert!(row.is_some_and(|row| row.contains("[CL]")), "{said}");
    let table = fs::read_to_string(case.path("results/study/published.csv")).unwrap();
    assert!(
        table.lines().count() == 2 && table.contains("98 % at 16:1,[CL],0.98,"),
        "{table}"
    );
    // The resolved study of the run can be run again.
    let again = fs::read_to_string(case.path("results/study/study.toml")).unwrap();
    case.file("again.toml", again);
    case.succeeds(&["plan", "again.toml"]);
}

#[test]
fn a_seed_of_the_command_line_is_one_that_a_file_may_have() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    let plan = |seed: u64| case.run(&["plan", "study.toml", "--seed", &seed.to_string()]);
    assert!(plan(i64::MAX as u64).status.success());
    let refused = plan(i64::MAX as u64 + 1);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8(refused.stderr).unwrap();
    assert!(
        said.contains("--seed: 9223372036854775808; a number below 2⁶³"),
        "{said}"
    );
}
