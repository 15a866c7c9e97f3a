//! Test that `bubbletouch features` writes exactly the rows with which a configuration is trained and tested.

use crate::command::{Case, says};
use bubbletouch::random::Seed;
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::recognition::classifiers::classifier::Classifier;
use bubbletouch::recognition::data::dataset::dataset;
use bubbletouch::study::read_features;
use ndarray::{Array1, Array2, Axis};
use ndarray_npy::read_npy;

/// Study with two noise levels, two ensembles, two m and two training sizes: 16 configurations with two trials each.
const STUDY: &str = include_str!("../fixtures/texts/features.toml");

fn written(case: &Case, configuration: usize, trial: usize) -> std::path::PathBuf {
    let folder = format!("cell_{configuration}_{trial}");
    let (configuration, trial) = (configuration.to_string(), trial.to_string());
    let (said, _) = case.succeeds(&format!(
        "features study.toml --configuration {configuration} --trial {trial} --out {folder}"
    ));
    assert_eq!(said, "");
    case.path(&folder)
}

#[test]
fn training_on_the_files_gives_the_accuracy_of_the_run() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    case.succeeds("run study.toml --out results");
    let mut table = csv::Reader::from_path(case.path("results/accuracy.csv")).unwrap();
    let header = table.headers().unwrap().clone();
    let column = |name: &str| header.iter().position(|column| column == name).unwrap();
    let (mut n_rows, mut counts) = (0, Vec::new());
    for row in table.records() {
        let row = row.unwrap();
        let number = |name: &str| row[column(name)].parse::<usize>().unwrap();
        let folder = written(&case, number("configuration"), number("trial"));
        let features: Array2<f64> = read_npy(folder.join("features.npy")).unwrap();
        let labels: Array1<i64> = read_npy(folder.join("labels.npy")).unwrap();
        let train: Array1<i64> = read_npy(folder.join("train.npy")).unwrap();
        let test: Array1<i64> = read_npy(folder.join("test.npy")).unwrap();
        assert_eq!(features.dim(), (72, number("measurements")));
        assert_eq!(train.len(), 3 * number("train_touches"));
        let rows = |rows: &Array1<i64>| {
            let rows: Vec<usize> = rows.iter().map(|&row| row as usize).collect();
            let labels = labels.select(Axis(0), &rows).mapv(|label| label as usize);
            dataset(features.select(Axis(0), &rows), labels).unwrap()
        };
        let classifier = Classifier::new(ClassifierKind::LinearSvm);
        let trained = classifier.train(&rows(&train), &Seed::new(0)).unwrap();
        let test = rows(&test);
        let predicted = trained.labels(test.records.view()).unwrap();
        let pairs = predicted.iter().zip(&test.targets);
        let n_correct = pairs.filter(|(a, b)| a == b).count();
        assert_eq!(n_correct, number("n_correct"), "{row:?}");
        n_rows += 1;
        counts.push(n_correct);
    }
    assert_eq!(n_rows, 32);
    counts.sort_unstable();
    counts.dedup();
    assert!(counts.len() > 4, "configurations differ: {counts:?}");
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
    for name in names.split(' ') {
        let read = |folder| case.bytes(&format!("{folder}/{name}"));
        assert!(read("1") == read("3"), "{name}");
    }
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
