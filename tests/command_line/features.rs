//! Test that `bubbletouch features` writes exactly the rows with which a configuration is trained and tested.

use crate::command::{Case, CommandLine, says};
use crate::study::Study;
use bubbletouch::study::progress::Silent;
use bubbletouch::study::read_features;
use ndarray::Array1;
use ndarray_npy::read_npy;

/// Study with two noise levels, two ensembles, two m and two training sizes: 16 configurations with two trials each.
const STUDY: &str = include_str!("../fixtures/texts/features.toml");

fn written(case: &Case, configuration: usize, trial: usize) -> std::path::PathBuf {
    let folder = format!("cell_{configuration}_{trial}");
    let cell = format!("--configuration {configuration} --trial {trial}");
    let (said, _) = case.succeeds(&format!("features study.toml {cell} --out {folder}"));
    assert_eq!(said, "");
    case.path(&folder)
}

/// Law: the files have the rows of the library, which give the accuracy of the run (`tests/studies/laws.rs`).
#[test]
fn the_files_hold_the_rows_of_the_library() {
    let case = Case::with("study.toml", STUDY);
    let study = Study::new(STUDY).of_items();
    // Configurations with and without noise, of both ensembles, numbers of measurements and of training touches.
    for cell in [(0, 0), (5, 1), (10, 0), (15, 1)] {
        let read = read_features(&written(&case, cell.0, cell.1)).unwrap();
        let expected = study.first().features(cell, &Silent).unwrap();
        assert_eq!(read.data, expected.data, "{cell:?}");
        assert_eq!(read.split, expected.split, "{cell:?}");
    }
}

#[test]
fn the_library_reads_what_the_command_writes_at_any_number_of_threads() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    for threads in ["1", "3"] {
        let features = "features study.toml --configuration 9";
        case.succeeds(&format!("{features} --threads {threads} --out {threads}"));
    }
    let names =
        "configuration.toml features.npy labels.npy manifest.json objects.csv test.npy train.npy";
    assert_eq!(case.names_in("1").join(" "), names);
    case.same_files(["1", "3"], &names.words());
    let set = read_features(&case.path("1")).unwrap();
    assert_eq!(set.data.records.dim().0, 72);
    assert_eq!(
        set.training(None).unwrap().records.nrows(),
        set.split.train.len()
    );
    assert_eq!(set.training(Some(5)).unwrap().records.nrows(), 5);
    let objects = case.read("1/objects.csv");
    assert_eq!(objects, "label,object\n0,mug\n1,banana\n2,scissors\n");
    let settings: toml::Table = case.read("1/configuration.toml").parse().unwrap();
    assert_eq!(
        settings["configuration"]["configuration"].as_integer(),
        Some(9)
    );
    assert_eq!(settings["n_train"].as_integer(), Some(36));
}

#[test]
fn groups_that_a_study_keeps_together_are_written_for_classify() {
    let case = Case::new();
    let keys = "group_by = \"yaw\"\ngroup_by_deg = 3.0\ntrain_touches = [4";
    case.file("study.toml", STUDY.replace("train_touches = [4", keys));
    let folder = written(&case, 0, 0);
    let groups: Array1<i64> = read_npy(folder.join("groups.npy")).unwrap();
    assert_eq!(groups.len(), 72);
    let folder = folder.display().to_string();
    let classify = format!("classify {folder} --classifier linear_svm");
    let (said, _) = case.succeeds(&format!("{classify} --groups {folder}/groups.npy"));
    says(&said, &["split     by groups:"]);
}
