//! `bubbletouch classify` accepts any folder of features, and checks it before training.

use crate::command::{Case, says, words};
use bubbletouch::random::Seed;
use bubbletouch::recognition::classifiers::classifier::Classifier;
use bubbletouch::recognition::data::dataset::dataset;
use bubbletouch::recognition::data::scaling::Scaling;
use bubbletouch::recognition::statistics::grouped::{
    GroupedTest, count_groups, interval_of_groups,
};
use bubbletouch::recognition::svm::{Multiclass, SvmSolver};
use bubbletouch::recognition::{ClassifierKind, ModelFile};
use bubbletouch::study::{KeyValue, write_texts};
use ndarray::{Array1, Array2, Axis, array};
use ndarray_npy::{read_npy, write_npy};
use serde_json::Value;

const N_ROWS: usize = 60;

/// Returns three overlapping classes of 20 rows with 5 features; every third row is a test row.
fn features() -> Array2<f64> {
    Array2::from_shape_fn((N_ROWS, 5), |(i, j)| {
        ((i % 3) * (j + 1) % 4) as f64 + 1.5 * ((i * 5 + j) as f64 * 1.7).sin()
    })
}

fn labels() -> Array1<i64> {
    (0..N_ROWS as i64).map(|row| row % 3).collect()
}

fn train() -> Array1<i64> {
    (0..N_ROWS as i64).filter(|row| row / 3 % 3 != 0).collect()
}

fn test() -> Array1<i64> {
    (0..N_ROWS as i64).filter(|row| row / 3 % 3 == 0).collect()
}

fn folder() -> Case {
    let case = Case::new();
    write_npy(case.path("features.npy"), &features()).unwrap();
    write_npy(case.path("labels.npy"), &labels()).unwrap();
    write_npy(case.path("train.npy"), &train()).unwrap();
    write_npy(case.path("test.npy"), &test()).unwrap();
    case
}

fn json(case: &Case, arguments: &[&str]) -> Value {
    let (said, _) = case.succeeds(&[&["classify", ".", "--json"], arguments].concat());
    serde_json::from_str(&said).unwrap()
}

#[test]
fn it_says_and_writes_what_the_library_predicts() {
    let case = folder();
    for (name, kind) in [
        ("linear_svm", ClassifierKind::LinearSvm),
        ("rbf_svm", ClassifierKind::RbfSvm),
        ("polynomial_svm", ClassifierKind::PolynomialSvm),
    ] {
        let said = json(&case, &["--classifier", name, "--predictions", "out.npy"]);
        let rows = |rows: Array1<i64>| {
            let rows: Vec<usize> = rows.iter().map(|&row| row as usize).collect();
            let labels = labels().select(Axis(0), &rows).mapv(|label| label as usize);
            dataset(features().select(Axis(0), &rows), labels).unwrap()
        };
        let trained = Classifier::new(kind)
            .train(&rows(train()), &Seed::new(0))
            .unwrap();
        let tested = rows(test());
        let expected = trained.labels(tested.records.view()).unwrap();
        let written: Array1<i64> = read_npy(case.path("out.npy")).unwrap();
        assert_eq!(written, expected.mapv(|label| label as i64), "{name}");
        let n_correct = expected.iter().zip(&tested.targets).filter(|(a, b)| a == b);
        assert_eq!(said["n_correct"], n_correct.count());
        assert_eq!(
            (&said["n_train"], &said["n_test"]),
            (&39.into(), &21.into())
        );
        assert_eq!(said["svm"]["n_problems"], 3);
        assert_eq!(said["svm"]["n_capped"], 0);
    }
}

/// The dual objective of one-vs-one SVMs decreases from 0 as C grows, because more is allowed. The fraction of support vectors also decreases.
#[test]
fn the_dual_objective_falls_as_c_grows() {
    let case = folder();
    let dual = |c: &str| {
        let said = json(&case, &["--classifier", "linear_svm", "--c", c]);
        said["svm"]["dual_objective"].as_f64().unwrap()
    };
    let duals = ["0.001", "0.1", "10"].map(dual);
    assert!(duals[0] > duals[1] && duals[1] > duals[2], "{duals:?}");
    // At C = 0.001, every multiplier is at most C; there are three problems of 26 rows.
    assert!(
        -duals[0] < 0.001 * 78.0 && -duals[0] > 0.5 * 0.001 * 78.0,
        "{duals:?}"
    );
}

#[test]
fn options_reach_the_classifier() {
    let case = folder();
    let accuracy_of = |arguments: &[&str]| json(&case, arguments)["svm"].clone();
    let rbf = ["--classifier", "rbf_svm"];
    let usual = accuracy_of(&rbf);
    for option in [
        ["--gamma", "3.5"],
        ["--c", "0.1"],
        ["--scaling", "none"],
        ["--multiclass", "one_vs_rest"],
        ["--train-rows", "30"],
    ] {
        assert_ne!(
            accuracy_of(&[&rbf[..], &option].concat()),
            usual,
            "{option:?}"
        );
    }
    let cubic = ["--classifier", "polynomial_svm"];
    let usual = accuracy_of(&cubic);
    for option in [["--degree", "2"], ["--coef0", "0.5"]] {
        assert_ne!(
            accuracy_of(&[&cubic[..], &option].concat()),
            usual,
            "{option:?}"
        );
    }
    let forest = ["--classifier", "random_forest"];
    let neighbours = ["--classifier", "k_nearest"];
    let correct = |arguments: &[&str]| json(&case, arguments)["n_correct"].clone();
    for (usual, option) in [
        (forest, ["--max-depth", "1"]),
        (forest, ["--n-trees", "1"]),
        (neighbours, ["--n-neighbours", "39"]),
    ] {
        let changed = correct(&[&usual[..], &option].concat());
        assert_ne!(changed, correct(&usual), "{option:?}");
    }
    let pure = [&forest[..], &["--max-depth", "pure"]].concat();
    assert_eq!(correct(&pure), correct(&forest));
    let said = json(&case, &["--classifier", "linear_svm", "--repeat", "3"]);
    assert_eq!(said["fit_s"].as_array().unwrap().len(), 3);
    assert_eq!(said["predict_s"].as_array().unwrap().len(), 3);
}

#[test]
fn people_get_lines() {
    let (said, error) = folder().succeeds(&["classify", ".", "--classifier", "linear_svm"]);
    assert_eq!(error, "");
    for word in [
        "39 to train on",
        "21 to test",
        "accuracy",
        "support vectors",
        "0 of 3",
    ] {
        assert!(said.contains(word), "{word}: {said}");
    }
}

/// Runs the command on a folder, and asserts that it fails with a message that contains all `words`.
fn refused(case: &Case, arguments: &[&str], words: &[&str]) {
    let all = [&["classify", "."], arguments].concat();
    let error = case.refuses(&[&all[..], &["--predictions", "out.npy"]].concat());
    for word in words {
        assert!(error.contains(word), "no {word:?} in: {error}");
    }
    assert!(!case.path("out.npy").exists());
}

const LINEAR: [&str; 2] = ["--classifier", "linear_svm"];

#[test]
fn a_feature_that_is_no_number_is_named_by_row_and_column() {
    let case = folder();
    for broken in [f64::NAN, f64::INFINITY] {
        let mut features = features();
        features[[7, 3]] = broken;
        write_npy(case.path("features.npy"), &features).unwrap();
        refused(&case, &LINEAR, &["features, row 7, column 3"]);
    }
}

#[test]
fn arrays_of_any_type_that_numpy_writes_are_read_as_the_same_numbers() {
    let case = folder();
    // Halves, which every floating-point type represents, and integers, which every integer type represents.
    let halves = features().mapv(|value| (2.0 * value).round() / 2.0);
    let whole = halves.mapv(f64::round);
    let path = |name: &str| case.path(name);
    let asked = |what: &str| {
        let said = json(&case, &["--classifier", "linear_svm"]);
        let svm = said["svm"]["dual_objective"].as_f64();
        (
            said["n_correct"].as_u64(),
            svm.unwrap_or_else(|| panic!("{what}: {said}")),
        )
    };
    write_npy(path("features.npy"), &halves).unwrap();
    let expected = asked("float64");
    write_npy(path("features.npy"), &halves.mapv(|value| value as f32)).unwrap();
    assert_eq!(asked("float32"), expected);
    write_npy(path("labels.npy"), &labels().mapv(|label| label as i32)).unwrap();
    write_npy(path("train.npy"), &train().mapv(|row| row as u16)).unwrap();
    assert_eq!(asked("int32 and uint16"), expected);
    let mask: Array1<bool> = (0..N_ROWS as i64)
        .map(|row| test().iter().any(|&tested| tested == row))
        .collect();
    write_npy(path("test.npy"), &mask).unwrap();
    assert_eq!(asked("a mask"), expected);
    write_npy(path("features.npy"), &whole).unwrap();
    let expected = asked("whole float64");
    write_npy(path("features.npy"), &whole.mapv(|value| value as i16)).unwrap();
    assert_eq!(asked("int16"), expected);
    let two: Array1<bool> = labels().mapv(|label| label == 1);
    write_npy(path("labels.npy"), &two.mapv(i64::from)).unwrap();
    write_npy(
        path("features.npy"),
        &whole.mapv(|value| f64::from(value > 0.0)),
    )
    .unwrap();
    let expected = asked("two classes");
    write_npy(path("labels.npy"), &two).unwrap();
    write_npy(path("features.npy"), &whole.mapv(|value| value > 0.0)).unwrap();
    assert_eq!(asked("bool"), expected);
}

/// Tests that all commands read labels in the same way: texts, integers from any start, one column per class, and archives.
#[test]
fn labels_of_every_form_are_answered_in_their_own_values() {
    let case = folder();
    let predictions = ["--classifier", "linear_svm", "--predictions", "out.npy"];
    let answered = || json(&case, &predictions)["n_correct"].as_u64().unwrap();
    let n_correct = answered();
    let usual: Array1<i64> = read_npy(case.path("out.npy")).unwrap();
    write_npy(
        case.path("labels.npy"),
        &labels().mapv(|n| 100.0 * n as f64 + 1.0),
    )
    .unwrap();
    assert_eq!(answered(), n_correct);
    let found: Array1<i64> = read_npy(case.path("out.npy")).unwrap();
    assert_eq!(found, usual.mapv(|label| 100 * label + 1));
    let n_classes = labels().iter().max().unwrap() + 1;
    let one_hot = Array2::from_shape_fn((N_ROWS, n_classes as usize), |(row, class)| {
        f64::from(u8::from(labels()[row] == class as i64))
    });
    write_npy(case.path("labels.npy"), &one_hot).unwrap();
    assert_eq!(answered(), n_correct);
    let found: Array1<i64> = read_npy(case.path("out.npy")).unwrap();
    assert_eq!(found, usual);
    std::fs::remove_file(case.path("labels.npy")).unwrap();
    let words: Vec<String> = labels()
        .iter()
        .map(|label| format!("kind {label}"))
        .collect();
    case.file("labels.csv", format!("{}\n", words.join("\n")));
    assert_eq!(answered(), n_correct);
    let bytes = std::fs::read(case.path("out.npy")).unwrap();
    assert!(String::from_utf8_lossy(&bytes[..80]).contains("'<U6'"));
    let last = usual.last().unwrap();
    let text: Vec<u8> = format!("kind {last}")
        .chars()
        .flat_map(|c| u32::from(c).to_le_bytes())
        .collect();
    assert!(bytes.ends_with(&text));
}

#[test]
fn arrays_of_another_type_or_shape_are_refused_by_name() {
    let case = folder();
    write_npy(case.path("features.npy"), &labels().mapv(|n| n as u64)).unwrap();
    refused(&case, &LINEAR, &["features.npy", "float64, float32"]);
    write_npy(
        case.path("features.npy"),
        &labels().mapv(|label| label as f64),
    )
    .unwrap();
    refused(&case, &LINEAR, &["features.npy", "n × m"]);
    write_npy(case.path("features.npy"), &features()).unwrap();
    write_npy(case.path("labels.npy"), &labels().mapv(|n| n as f64 + 0.5)).unwrap();
    refused(&case, &LINEAR, &["labels.npy, position 0", "int64"]);
    write_npy(case.path("labels.npy"), &labels()).unwrap();
    write_npy(case.path("test.npy"), &array![true, false]).unwrap();
    refused(
        &case,
        &LINEAR,
        &["test.npy", "a mask of 2 rows", "one of 60"],
    );
    write_npy(case.path("test.npy"), &test()).unwrap();
    write_npy(case.path("labels.npy"), &array![0_i64, 1, 2]).unwrap();
    refused(&case, &LINEAR, &["3 labels", "each of the 60 rows"]);
    case.file("labels.npy", "0,1,2");
    refused(&case, &LINEAR, &["labels.npy"]);
    std::fs::remove_file(case.path("labels.npy")).unwrap();
    refused(&case, &LINEAR, &["labels.npy", "cannot be read"]);
}

#[test]
fn rows_that_are_not_there_or_named_twice_are_refused() {
    let case = folder();
    for (file, rows, words) in [
        (
            "train.npy",
            array![1_i64, 60],
            ["train.npy, position 1: 60", "0 to 59"],
        ),
        (
            "train.npy",
            array![-1, 4],
            ["train.npy, position 0: -1", "0 to 59"],
        ),
        (
            "test.npy",
            array![0, 7, 7],
            ["test.npy: row 7 twice", "at most once"],
        ),
        (
            "test.npy",
            array![0, 3],
            ["row 3, which train.npy names too", "at most once"],
        ),
        ("test.npy", array![], ["test.npy: no rows", "at least one"]),
    ] {
        write_npy(case.path("train.npy"), &array![1_i64, 2, 3, 4, 5, 6]).unwrap();
        write_npy(case.path("test.npy"), &array![0_i64]).unwrap();
        write_npy(case.path(file), &rows).unwrap();
        refused(&case, &LINEAR, &words);
    }
    let mut labels = labels();
    labels[4] = -2;
    write_npy(case.path("labels.npy"), &labels).unwrap();
    refused(&case, &LINEAR, &["labels.npy, position 4: -2"]);
}

/// Returns five groups of 12 rows; each group has rows of all classes, and both sides of the split contain whole groups.
fn groups() -> Array1<i64> {
    (0..N_ROWS as i64).map(|row| 7 * (row / 12)).collect()
}

/// Creates a folder in which two of five groups are test groups.
fn grouped_folder() -> Case {
    let case = folder();
    let side = |is_tested: bool| -> Array1<i64> {
        let rows = 0..N_ROWS as i64;
        rows.filter(|row| (row / 12 % 2 == 1) == is_tested)
            .collect()
    };
    write_npy(case.path("train.npy"), &side(false)).unwrap();
    write_npy(case.path("test.npy"), &side(true)).unwrap();
    write_npy(case.path("groups.npy"), &groups()).unwrap();
    case
}

const GROUPED: [&str; 4] = ["--classifier", "linear_svm", "--groups", "groups.npy"];

#[test]
fn groups_change_the_interval_and_the_folds_and_nothing_else() {
    let case = grouped_folder();
    let (by_rows, by_groups) = (json(&case, &LINEAR), json(&case, &GROUPED));
    assert_eq!(
        [&by_rows["split_by"], &by_groups["split_by"]],
        ["rows", "groups"]
    );
    assert!(by_rows["n_test_groups"].is_null());
    assert_eq!(by_groups["n_train_groups"], 3);
    assert_eq!(by_groups["n_test_groups"], 2);
    assert_eq!(by_rows["n_correct"], by_groups["n_correct"]);
    // Groups of the test rows, computed from the predictions.
    case.succeeds(
        &[
            &["classify", "."],
            &GROUPED[..],
            &["--predictions", "out.npy"],
        ]
        .concat(),
    );
    let predicted: Array1<i64> = read_npy(case.path("out.npy")).unwrap();
    let tested: Array1<i64> = read_npy(case.path("test.npy")).unwrap();
    let rows = tested.iter().zip(&predicted);
    let rows = rows.map(|(&row, &label)| (groups()[row as usize] as usize, label == row % 3));
    let counts = count_groups(rows);
    let test = GroupedTest {
        n_rows: tested.len(),
        n_correct: counts.iter().map(|count| count.n_correct).sum(),
        groups: &counts,
    };
    let (interval, _) = interval_of_groups(&[test], 0.95).unwrap();
    assert_eq!(by_groups["accuracy_low"].as_f64(), Some(interval.low));
    assert_eq!(by_groups["accuracy_high"].as_f64(), Some(interval.high));
    let wider = |low: &str| by_groups[low].as_f64() < by_rows[low].as_f64();
    assert!(wider("accuracy_low"));
    // Folds of whole groups choose on other rows.
    let chosen = ["--c-grid", "0.01,0.1,1", "--cv-folds", "3"];
    let validated = |of: &[&str]| json(&case, &[of, &chosen].concat())["chosen"]["tried"].clone();
    assert_ne!(validated(&GROUPED), validated(&LINEAR));
}

#[test]
fn people_read_that_groups_were_held_out_and_that_two_are_few() {
    let (said, _) = grouped_folder().succeeds(&[&["classify", "."], &GROUPED[..]].concat());
    let line = "split     by groups: 3 to train on, 2 to test; the interval comes from 2 groups, too few for a narrow interval";
    assert!(said.contains(line), "{said}");
}

#[test]
fn groups_that_do_not_fit_the_rows_or_the_split_are_refused() {
    let case = grouped_folder();
    let with = |groups: Array1<i64>, arguments: &[&str], words: &[&str]| {
        write_npy(case.path("groups.npy"), &groups).unwrap();
        refused(&case, &[&GROUPED[..], arguments].concat(), words);
    };
    with(
        array![1, 2, 3],
        &[],
        &["groups.npy: 3 groups", "60, one for each row of features"],
    );
    with(
        Array1::zeros(N_ROWS),
        &[],
        &["groups.npy: group 0 of row", "train.npy", "test.npy"],
    );
    let mut one_row = groups();
    one_row[30] = 7;
    with(
        one_row,
        &[],
        &["group 7 of row 30 in train.npy and row 12 in test.npy"],
    );
    let mut below = groups();
    below[4] = -1;
    with(below, &[], &["groups.npy, position 4: -1", "zero or more"]);
    with(
        groups(),
        &["--c-grid", "1,10"],
        &["folds: 5", "at most 3 with these groups"],
    );
    write_npy(
        case.path("groups.npy"),
        &groups().mapv(|group| group as f64 + 0.5),
    )
    .unwrap();
    refused(
        &case,
        &GROUPED,
        &["groups.npy, position 0: ", "int8 to int64", "whole floats"],
    );
    refused(
        &case,
        &["--classifier", "linear_svm", "--groups", "none.npy"],
        &["none.npy", "cannot be read"],
    );
}

#[test]
fn options_out_of_range_are_refused() {
    let case = folder();
    for (classifier, option, value, word) in [
        (
            "polynomial_svm",
            "--degree",
            "21",
            "at least 1 and at most 20",
        ),
        ("polynomial_svm", "--degree", "2.5", "a whole number"),
        ("polynomial_svm", "--coef0=-1", "", "0 to 1e6"),
        ("rbf_svm", "--gamma", "0", "1e-12 to 1e9"),
        ("rbf_svm", "--gamma", "NaN", "1e-12 to 1e9"),
        ("random_forest", "--n-trees", "0", "at least 1"),
        ("random_forest", "--max-depth", "deep", "pure"),
        ("k_nearest", "--n-neighbours", "40", "39 training rows"),
    ] {
        let mut options = vec!["--classifier", classifier, option, value];
        options.retain(|option| !option.is_empty());
        refused(&case, &options, &[word]);
    }
    for (option, value, word) in [
        ("--classifier", "forest of trees", "linear_svm"),
        ("--gamma", "wide", "scale"),
        ("--multiclass", "all", "one_vs_rest"),
        ("--scaling", "robust", "overall"),
        ("--repeat", "0", "at least 1"),
        ("--train-rows", "40", "1 to 39"),
        ("--train-rows", "0", "1 to 39"),
        ("--c", "0", "above 0"),
        ("--tolerance", "0", "above 0"),
        ("--threads", "0", "1 to 1024"),
    ] {
        let named = option == "--classifier";
        let first: &[&str] = if named { &[] } else { &LINEAR };
        refused(&case, &[first, &[option, value]].concat(), &[word]);
    }
}

/// Law of all kinds that can be saved: a classifier that was written and read has the scores and labels of the classifier itself, in all bits.
#[test]
fn a_saved_classifier_predicts_what_it_predicted_before() {
    let case = Case::new();
    let rows = |n: usize, phase: f64| {
        let values = Array2::from_shape_fn((n, 5), |(i, j)| {
            ((i % 4) * (j + 1) % 4) as f64 + 1.5 * ((i * 5 + j) as f64 * 1.7 + phase).sin()
        });
        let labels = (0..n).map(|row| [1, 3, 4, 7][row % 4]).collect();
        dataset(values, labels).unwrap()
    };
    let (training, tested) = (rows(120, 0.0), rows(700, 0.4));
    let classes: Vec<KeyValue> = (0..8).map(KeyValue::Integer).collect();
    let kinds = [
        "linear_svm",
        "rbf_svm",
        "laplacian_svm",
        "polynomial_svm",
        "nearest_centroid",
        "naive_bayes",
        "logistic_regression",
        "k_nearest",
        "random_forest",
    ];
    let mut classifiers: Vec<Classifier> = kinds
        .iter()
        .map(|&kind| Classifier::new(toml::Value::from(kind).try_into().unwrap()))
        .collect();
    for kind in [ClassifierKind::LinearSvm, ClassifierKind::RbfSvm] {
        classifiers.push(Classifier {
            multiclass: Multiclass::OneVsRest,
            scaling: Scaling::Overall,
            ..Classifier::new(kind)
        });
        classifiers.push(Classifier {
            tolerance: 1e-9,
            ..Classifier::new(kind)
        });
    }
    classifiers.push(Classifier {
        multiclass: Multiclass::OneVsRest,
        solver: SvmSolver::CoordinateDescent,
        ..Classifier::new(ClassifierKind::LinearSvm)
    });
    for settings in classifiers {
        let classifier = settings.train(&training, &Seed::new(3)).unwrap();
        let kind = settings.kind;
        let path = case.path("model.json");
        let written = ModelFile {
            kind,
            classes: classes.clone(),
            columns: None,
            classifier,
        };
        written.write(&path).unwrap();
        let read = ModelFile::read(&path).unwrap();
        assert_eq!((read.kind, &read.classes), (kind, &written.classes));
        let bits = |of: &ModelFile| {
            let features = tested.records.view();
            let scores = of.classifier.scores(features).unwrap();
            (
                scores.mapv(f64::to_bits),
                of.classifier.labels(features).unwrap(),
            )
        };
        assert_eq!(bits(&read), bits(&written), "{settings:?}");
        let few = tested.records.slice(ndarray::s![..3, ..]);
        let labels = |of: &ModelFile| of.classifier.labels(few).unwrap();
        assert_eq!(labels(&read), labels(&written), "{settings:?}");
    }
}

#[test]
fn a_saved_classifier_is_applied_to_new_touches() {
    let case = folder();
    let names: Vec<String> = labels()
        .iter()
        .map(|label| format!("class {label}"))
        .collect();
    write_texts(&case.path("labels.npy"), &names).unwrap();
    let save = [
        "--classifier",
        "rbf_svm",
        "--save",
        "model.json",
        "--predictions",
        "a.npy",
    ];
    let trained = json(&case, &save);
    let applied = json(&case, &["--model", "model.json", "--predictions", "b.npy"]);
    assert_eq!(applied["n_correct"], trained["n_correct"]);
    assert_eq!(applied["n_rows"], trained["n_test"]);
    let bytes = |name: &str| std::fs::read(case.path(name)).unwrap();
    assert_eq!(bytes("a.npy"), bytes("b.npy"));
    // Touches without labels and without a split.
    let new = Case::new();
    let rows: Vec<usize> = test().iter().map(|&row| row as usize).collect();
    write_npy(new.path("features.npy"), &features().select(Axis(0), &rows)).unwrap();
    let model = case.path("model.json");
    let model = model.to_str().unwrap();
    let applied = json(&new, &["--model", model, "--predictions", "c.npy"]);
    assert!(applied["accuracy"].is_null());
    assert_eq!(bytes("a.npy"), std::fs::read(new.path("c.npy")).unwrap());
}

#[test]
fn a_saved_classifier_refuses_touches_whose_columns_have_another_order() {
    let case = folder();
    let features = features();
    let table = |names: [&str; 2]| {
        let line = |row: ndarray::ArrayView1<f64>| format!("{},{}\n", row[0], row[1]);
        let lines: String = features.rows().into_iter().map(line).collect();
        format!("{}\n{lines}", names.join(","))
    };
    std::fs::remove_file(case.path("features.npy")).unwrap();
    case.file("features.csv", table(["pressure", "shear"]));
    json(
        &case,
        &["--classifier", "k_nearest", "--save", "model.json"],
    );
    let apply = words("classify . --model model.json");
    assert_eq!(case.run(&apply).status.code(), Some(0));
    case.file("features.csv", table(["shear", "pressure"]));
    says(
        &case.refuses(&apply),
        &[
            "features.csv: column `shear` in the place of `pressure`; the columns of the training rows, in their order",
        ],
    );
}

#[test]
fn another_or_a_damaged_file_of_a_classifier_is_refused() {
    let case = folder();
    json(
        &case,
        &["--classifier", "nearest_centroid", "--save", "model.json"],
    );
    let text = std::fs::read_to_string(case.path("model.json")).unwrap();
    let refused = |text: &str, wanted: &str| {
        case.file("other.json", text);
        let output = case.run(&["classify", ".", "--model", "other.json"]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(
            said.contains("other.json: ") && said.contains(wanted),
            "{said}"
        );
        assert_eq!(said.trim().lines().count(), 1, "{said}");
    };
    refused("", "another format");
    refused("{}", "another format");
    refused(&text[..text.len() / 2], "another format");
    refused(&text.replace("\"version\":2", "\"version\":3"), "version 3");
    let at = text.find("\"offset\":[[5],\"").unwrap() + 16;
    let digit = if &text[at..=at] == "0" { "1" } else { "0" };
    let changed = format!("{}{digit}{}", &text[..at], &text[at + 1..]);
    refused(&changed, "was changed");
    refused(
        &text.replacen("\"classes\":[0,1", "\"classes\":[1,0", 1),
        "was changed",
    );
    let said = case.refuses(&words("classify . --classifier linfa_svm --save m.json"));
    says(&said, &["cannot be saved"]);
    let both = ["classify", ".", "--model", "model.json", "--n-trees", "3"];
    assert_eq!(case.run(&both).status.code(), Some(2));
}

#[test]
fn a_label_among_the_features_is_noted() {
    let case = folder();
    let classify = ["classify", ".", "--classifier", "nearest_centroid"];
    let (_, said) = case.succeeds(&classify);
    assert!(!said.contains("one value for each class"), "{said}");
    let line = |row: &[f64], label: &i64| {
        let [a, b, ..] = row else {
            panic!("5 features")
        };
        format!("{a},{},{b}\n", 7 - 2 * label)
    };
    let (features, labels) = (features(), labels());
    let rows = features.rows().into_iter().zip(&labels);
    let rows = rows.map(|(row, label)| line(row.as_slice().unwrap(), label));
    let text = "mean,label,std\n".to_owned() + &rows.collect::<String>();
    std::fs::remove_file(case.path("features.npy")).unwrap();
    case.file("features.csv", text);
    let (_, said) = case.succeeds(&classify);
    let words = "note: .: column 2 of the features has one value for each class; remove it if it is the label";
    assert!(said.contains(words), "{said}");
}
