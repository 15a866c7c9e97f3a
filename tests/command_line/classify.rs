//! `bubbletouch classify` accepts any folder of features, and checks it before training.

use crate::arrays::npy;
use crate::command::{Case, contains, says};
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
use ndarray_npy::read_npy;
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

/// Returns the test rows, or the training rows.
fn rows(is_tested: bool) -> Array1<i64> {
    let rows = 0..N_ROWS as i64;
    rows.filter(|row| (row / 3 % 3 == 0) == is_tested).collect()
}

fn folder() -> Case {
    let case = Case::with("features.npy", npy(&features()));
    case.file("labels.npy", npy(&labels()));
    case.file("train.npy", npy(&rows(false)));
    case.file("test.npy", npy(&rows(true)));
    case
}

const LINEAR: &str = "--classifier linear_svm";

fn json(case: &Case, options: &str) -> Value {
    let (said, _) = case.succeeds(&format!("classify . --json {options}"));
    serde_json::from_str(&said).unwrap()
}

fn read(case: &Case, name: &str) -> Array1<i64> {
    read_npy(case.path(name)).unwrap()
}

#[test]
fn it_says_and_writes_what_the_library_predicts() {
    let case = folder();
    for (name, kind) in [
        ("linear_svm", ClassifierKind::LinearSvm),
        ("rbf_svm", ClassifierKind::RbfSvm),
        ("polynomial_svm", ClassifierKind::PolynomialSvm),
    ] {
        let said = json(&case, &format!("--classifier {name} --predictions out.npy"));
        let side = |is_tested: bool| {
            let rows = rows(is_tested).mapv(|row| row as usize).to_vec();
            let labels = labels().select(Axis(0), &rows).mapv(|label| label as usize);
            dataset(features().select(Axis(0), &rows), labels).unwrap()
        };
        let trained = Classifier::new(kind).train(&side(false), &Seed::new(0));
        let tested = side(true);
        let expected = trained.unwrap().labels(tested.records.view()).unwrap();
        assert_eq!(
            read(&case, "out.npy"),
            expected.mapv(|label| label as i64),
            "{name}"
        );
        let n_correct = expected.iter().zip(&tested.targets).filter(|(a, b)| a == b);
        assert_eq!(said["n_correct"], n_correct.count());
        let counts = ["n_train", "n_test"].map(|key| &said[key]);
        assert_eq!(counts, [39, 21]);
        let counts = ["n_problems", "n_capped"].map(|key| &said["svm"][key]);
        assert_eq!(counts, [3, 0]);
    }
}

/// The dual objective of one-vs-one SVMs decreases from 0 as C grows, because more is allowed. The fraction of support vectors also decreases.
#[test]
fn the_dual_objective_falls_as_c_grows() {
    let case = folder();
    let duals = [0.001, 0.1, 10.0].map(|c| {
        let said = json(&case, &format!("{LINEAR} --c {c}"));
        said["svm"]["dual_objective"].as_f64().unwrap()
    });
    assert!(duals[0] > duals[1] && duals[1] > duals[2], "{duals:?}");
    // At C = 0.001, every multiplier is at most C; there are three problems of 26 rows.
    let share = -duals[0] / (0.001 * 78.0);
    assert!(share > 0.5 && share < 1.0, "{duals:?}");
}

#[test]
fn options_reach_the_classifier() {
    let case = folder();
    for (classifier, what, option) in [
        ("rbf_svm", "svm", "--gamma 3.5"),
        ("rbf_svm", "svm", "--c 0.1"),
        ("rbf_svm", "svm", "--scaling none"),
        ("rbf_svm", "svm", "--multiclass one_vs_rest"),
        ("rbf_svm", "svm", "--train-rows 30"),
        ("polynomial_svm", "svm", "--degree 2"),
        ("polynomial_svm", "svm", "--coef0 0.5"),
        ("random_forest", "n_correct", "--max-depth 1"),
        ("random_forest", "n_correct", "--n-trees 1"),
        ("k_nearest", "n_correct", "--n-neighbours 39"),
    ] {
        let with = |option: &str| json(&case, &format!("--classifier {classifier} {option}"));
        assert_ne!(with(option)[what], with("")[what], "{option:?}");
    }
    let forest = |option: &str| json(&case, &format!("--classifier random_forest {option}"));
    assert_eq!(
        forest("--max-depth pure")["n_correct"],
        forest("")["n_correct"]
    );
    let said = json(&case, &format!("{LINEAR} --repeat 3"));
    for times in ["fit_s", "predict_s"] {
        assert_eq!(said[times].as_array().unwrap().len(), 3);
    }
}

#[test]
fn people_get_lines() {
    let (said, error) = folder().succeeds("classify . --classifier linear_svm");
    assert_eq!(error, "");
    let words = "39 to train on … 21 to test … accuracy … support vectors … 0 of 3";
    assert!(contains(&said, words), "{said}");
}

#[test]
fn arrays_of_any_type_that_numpy_writes_are_read_as_the_same_numbers() {
    let case = folder();
    // Halves, which every floating-point type represents, and integers, which every integer type represents.
    let halves = features().mapv(|value| (2.0 * value).round() / 2.0);
    let whole = halves.mapv(f64::round);
    let asked = |what: &str| {
        let said = json(&case, LINEAR);
        let dual = said["svm"]["dual_objective"].as_f64();
        (
            said["n_correct"].as_u64(),
            dual.unwrap_or_else(|| panic!("{what}: {said}")),
        )
    };
    case.file("features.npy", npy(&halves));
    let expected = asked("float64");
    case.file("features.npy", npy(&halves.mapv(|value| value as f32)));
    assert_eq!(asked("float32"), expected);
    case.file("labels.npy", npy(&labels().mapv(|label| label as i32)));
    case.file("train.npy", npy(&rows(false).mapv(|row| row as u16)));
    assert_eq!(asked("int32 and uint16"), expected);
    let mask: Array1<bool> = (0..N_ROWS).map(|row| row / 3 % 3 == 0).collect();
    case.file("test.npy", npy(&mask));
    assert_eq!(asked("a mask"), expected);
    case.file("features.npy", npy(&whole));
    let expected = asked("whole float64");
    case.file("features.npy", npy(&whole.mapv(|value| value as i16)));
    assert_eq!(asked("int16"), expected);
    let (two, above) = (
        labels().mapv(|label| label == 1),
        whole.mapv(|value| value > 0.0),
    );
    case.file("labels.npy", npy(&two.mapv(i64::from)));
    case.file(
        "features.npy",
        npy(&above.mapv(|value| f64::from(u8::from(value)))),
    );
    let expected = asked("two classes");
    case.file("labels.npy", npy(&two));
    case.file("features.npy", npy(&above));
    assert_eq!(asked("bool"), expected);
}

/// Tests that all commands read labels in the same way: texts, integers from any start, one column per class, and archives.
#[test]
fn labels_of_every_form_are_answered_in_their_own_values() {
    let case = folder();
    let answered = || json(&case, &format!("{LINEAR} --predictions out.npy"))["n_correct"].clone();
    let (n_correct, usual) = (answered(), read(&case, "out.npy"));
    case.file(
        "labels.npy",
        npy(&labels().mapv(|n| 100.0 * n as f64 + 1.0)),
    );
    assert_eq!(answered(), n_correct);
    assert_eq!(read(&case, "out.npy"), usual.mapv(|label| 100 * label + 1));
    let one_hot = Array2::from_shape_fn((N_ROWS, 3), |(row, class)| {
        f64::from(u8::from(row % 3 == class))
    });
    case.file("labels.npy", npy(&one_hot));
    assert_eq!(answered(), n_correct);
    assert_eq!(read(&case, "out.npy"), usual);
    case.remove("labels.npy");
    let words = labels().mapv(|label| format!("kind {label}\n"));
    case.file("labels.csv", words.to_vec().concat());
    assert_eq!(answered(), n_correct);
    let bytes = case.bytes("out.npy");
    assert!(String::from_utf8_lossy(&bytes[..80]).contains("'<U6'"));
    let last = format!("kind {}", usual.last().unwrap());
    let text: Vec<u8> = last
        .chars()
        .flat_map(|c| u32::from(c).to_le_bytes())
        .collect();
    assert!(bytes.ends_with(&text));
}

/// Asserts that the command refuses a folder with a message that contains the words in their order, and writes no predictions.
#[track_caller]
fn refused(case: &Case, options: &str, words: &str) {
    let error = case.refuses(&format!("classify . {options} --predictions out.npy"));
    assert!(contains(&error, words), "no {words:?} in: {error}");
    assert!(!case.path("out.npy").exists());
}

#[test]
fn arrays_that_cannot_be_trained_on_are_refused_by_name() {
    let feature = |broken: f64| {
        let mut features = features();
        features[[7, 3]] = broken;
        npy(&features)
    };
    let each = |of: fn(f64) -> f64| npy(&labels().mapv(|label| of(label as f64)));
    let mut negative = labels();
    negative[4] = -2;
    let rows = |rows: &[i64]| npy(&Array1::from(rows.to_vec()));
    let mask = npy(&array![true, false]);
    let whole = npy(&labels().mapv(|label| label as u64));
    for (name, bytes, words) in [
        ("features", feature(f64::NAN), "row 7, column 3"),
        ("features", feature(f64::INFINITY), "row 7, column 3"),
        ("features", whole, "float64, float32"),
        ("features", each(|label| label), "n × m"),
        ("labels", each(|label| label + 0.5), "position 0 … int64"),
        ("labels", rows(&[0, 1, 2]), "3 values … 60, one a row"),
        ("labels", b"0,1,2".to_vec(), ".npy"),
        ("labels", npy(&negative), "position 4: -2"),
        ("test", mask, "a mask of 2 rows … one of 60"),
        ("train", rows(&[1, 60]), "position 1: 60 … 0 to 59"),
        ("train", rows(&[-1, 4]), "position 0: -1 … 0 to 59"),
        ("test", rows(&[0, 7, 7]), "row 7 twice … at most once"),
        ("test", rows(&[0, 3]), "row 3, which train.npy names too"),
        ("test", rows(&[]), "no rows … at least one"),
    ] {
        let case = folder();
        if name == "test" {
            case.file("train.npy", rows(&[1, 2, 3, 4, 5, 6]));
        }
        case.file(&format!("{name}.npy"), bytes);
        refused(&case, LINEAR, &format!("{name} … {words}"));
    }
    let case = folder();
    case.remove("labels.npy");
    refused(&case, LINEAR, "labels.npy … cannot be read");
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
    case.file("train.npy", npy(&side(false)));
    case.file("test.npy", npy(&side(true)));
    case.file("groups.npy", npy(&groups()));
    case
}

const GROUPED: &str = "--classifier linear_svm --groups groups.npy";

#[test]
fn groups_change_the_interval_and_the_folds_and_nothing_else() {
    let case = grouped_folder();
    let by_rows = json(&case, LINEAR);
    let by_groups = json(&case, &format!("{GROUPED} --predictions out.npy"));
    assert_eq!(
        [&by_rows["split_by"], &by_groups["split_by"]],
        ["rows", "groups"]
    );
    assert!(by_rows["n_test_groups"].is_null());
    assert_eq!(
        [&by_groups["n_train_groups"], &by_groups["n_test_groups"]],
        [3, 2]
    );
    assert_eq!(by_rows["n_correct"], by_groups["n_correct"]);
    // Groups of the test rows, computed from the predictions.
    let (predicted, tested) = (read(&case, "out.npy"), read(&case, "test.npy"));
    let rows = tested.iter().zip(&predicted);
    let rows = rows.map(|(&row, &label)| (groups()[row as usize] as usize, label == row % 3));
    let counts = count_groups(rows);
    let test = GroupedTest {
        n_rows: tested.len(),
        n_correct: counts.iter().map(|count| count.n_correct).sum(),
        groups: &counts,
    };
    let (interval, _) = interval_of_groups(&[test], 0.95).unwrap();
    let ends = ["accuracy_low", "accuracy_high"].map(|key| by_groups[key].as_f64().unwrap());
    assert_eq!(ends, [interval.low, interval.high]);
    assert!(ends[0] < by_rows["accuracy_low"].as_f64().unwrap());
    // Folds of whole groups choose on other rows.
    let validated = |options: &str| {
        let said = json(
            &case,
            &format!("{options} --c-grid 0.01,0.1,1 --cv-folds 3"),
        );
        said["chosen"]["tried"].clone()
    };
    assert_ne!(validated(GROUPED), validated(LINEAR));
    let (said, _) = case.succeeds(&format!("classify . {GROUPED}"));
    let split = "split     by groups: 3 to train on, 2 to test; the interval comes from 2 groups, too few for a narrow interval";
    says(&said, &[split]);
}

#[test]
fn groups_that_do_not_fit_the_rows_or_the_split_are_refused() {
    let with = |row: usize, group: i64| {
        let mut groups = groups();
        groups[row] = group;
        npy(&groups)
    };
    let halves = npy(&groups().mapv(|group| group as f64 + 0.5));
    let one = npy(&Array1::<i64>::zeros(N_ROWS));
    let folds = "folds: 5 … at most 3 with these groups";
    for (groups, options, words) in [
        (npy(&array![1, 2, 3]), "", "3 values … 60, one a row"),
        (one, "", "group 0 of row … train.npy … test.npy"),
        (with(30, 7), "", "group 7 of row 30 in train.npy and row 12"),
        (with(4, -1), "", "groups.npy, position 4: -1 … zero or more"),
        (npy(&groups()), "--c-grid 1,10", folds),
        (halves, "", "position 0: … int8 to int64 … whole floats"),
    ] {
        let case = grouped_folder();
        case.file("groups.npy", groups);
        refused(&case, &format!("{GROUPED} {options}"), words);
    }
    let case = grouped_folder();
    case.remove("groups.npy");
    refused(&case, GROUPED, "groups.npy … cannot be read");
}

#[test]
fn options_out_of_range_are_refused() {
    let case = folder();
    for (options, words) in [
        ("polynomial_svm --degree 21", "at least 1 and at most 20"),
        ("polynomial_svm --degree 2.5", "a whole number"),
        ("polynomial_svm --coef0=-1", "0 to 1e6"),
        ("rbf_svm --gamma 0", "1e-12 to 1e9"),
        ("rbf_svm --gamma NaN", "1e-12 to 1e9"),
        ("random_forest --n-trees 0", "at least 1"),
        ("random_forest --max-depth deep", "pure"),
        ("k_nearest --n-neighbours 40", "39 training rows"),
        ("forest", "linear_svm"),
        ("linear_svm --gamma wide", "scale"),
        ("linear_svm --multiclass all", "one_vs_rest"),
        ("linear_svm --scaling robust", "overall"),
        ("linear_svm --repeat 0", "at least 1"),
        ("linear_svm --train-rows 40", "1 to 39"),
        ("linear_svm --train-rows 0", "1 to 39"),
        ("linear_svm --c 0", "above 0"),
        ("linear_svm --tolerance 0", "above 0"),
        ("linear_svm --threads 0", "1 to 1024"),
    ] {
        refused(&case, &format!("--classifier {options}"), words);
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
    let kinds = "linear_svm rbf_svm polynomial_svm nearest_centroid naive_bayes \
                 logistic_regression k_nearest random_forest";
    let kinds = kinds.split_whitespace();
    let usual = kinds.map(|kind| Classifier::new(toml::Value::from(kind).try_into().unwrap()));
    let mut classifiers: Vec<Classifier> = usual.collect();
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
        let path = case.path("model.json");
        let written = ModelFile {
            kind: settings.kind,
            classes: (0..8).map(KeyValue::Integer).collect(),
            columns: None,
            classifier: settings.train(&training, &Seed::new(3)).unwrap(),
        };
        written.write(&path).unwrap();
        let read = ModelFile::read(&path).unwrap();
        assert_eq!((read.kind, &read.classes), (written.kind, &written.classes));
        let bits = |of: &ModelFile| {
            let features = tested.records.view();
            let few = tested.records.slice(ndarray::s![..3, ..]);
            let scores = of.classifier.scores(features).unwrap();
            let labels = [features, few].map(|rows| of.classifier.labels(rows).unwrap());
            (scores.mapv(f64::to_bits), labels)
        };
        assert_eq!(bits(&read), bits(&written), "{settings:?}");
    }
}

#[test]
fn a_saved_classifier_is_applied_to_new_touches() {
    let case = folder();
    let names = labels().mapv(|label| format!("class {label}")).to_vec();
    write_texts(&case.path("labels.npy"), &names).unwrap();
    let trained = json(
        &case,
        "--classifier rbf_svm --save model.json --predictions a.npy",
    );
    let applied = json(&case, "--model model.json --predictions b.npy");
    assert_eq!(applied["n_correct"], trained["n_correct"]);
    assert_eq!(applied["n_rows"], trained["n_test"]);
    assert_eq!(case.bytes("a.npy"), case.bytes("b.npy"));
    // Touches without labels and without a split.
    let rows = rows(true).mapv(|row| row as usize).to_vec();
    let new = Case::with("features.npy", npy(&features().select(Axis(0), &rows)));
    let model = case.path("model.json");
    let applied = json(
        &new,
        &format!("--model {} --predictions c.npy", model.display()),
    );
    assert!(applied["accuracy"].is_null());
    assert_eq!(case.bytes("a.npy"), new.bytes("c.npy"));
}

#[test]
fn a_saved_classifier_refuses_touches_whose_columns_have_another_order() {
    let case = folder();
    let table = |header: &str| {
        let line = |row: ndarray::ArrayView1<f64>| format!("{},{}\n", row[0], row[1]);
        let lines = features().rows().into_iter().map(line).collect::<String>();
        format!("{header}\n{lines}")
    };
    case.remove("features.npy");
    case.file("features.csv", table("pressure,shear"));
    json(&case, "--classifier k_nearest --save model.json");
    case.succeeds("classify . --model model.json");
    case.file("features.csv", table("shear,pressure"));
    let error = case.refuses("classify . --model model.json");
    let columns = "features.csv: column `shear` in the place of `pressure`; the columns of the training rows, in their order";
    says(&error, &[columns]);
}

#[test]
fn another_or_a_damaged_file_of_a_classifier_is_refused() {
    let case = folder();
    json(&case, "--classifier nearest_centroid --save model.json");
    let text = case.read("model.json");
    let at = text.find("\"offset\":[[5],\"").unwrap() + 16;
    let digit = if &text[at..=at] == "0" { "1" } else { "0" };
    let changed = format!("{}{digit}{}", &text[..at], &text[at + 1..]);
    for (text, words) in [
        ("", "another format"),
        ("{}", "another format"),
        (&text[..text.len() / 2], "another format"),
        (&text.replace("\"version\":2", "\"version\":3"), "version 3"),
        (&changed, "was changed"),
        (
            &text.replacen("\"classes\":[0,1", "\"classes\":[1,0", 1),
            "was changed",
        ),
    ] {
        case.file("other.json", text);
        let said = case.refuses("classify . --model other.json");
        says(&said, &["other.json: ", words]);
        assert_eq!(said.trim().lines().count(), 1, "{said}");
    }
    let said = case.refuses("classify . --classifier linfa_svm --save m.json");
    says(&said, &["cannot be saved"]);
    case.refuses("classify . --model model.json --n-trees 3");
}

#[test]
fn a_label_among_the_features_is_noted() {
    let case = folder();
    let classify = "classify . --classifier nearest_centroid";
    let (_, said) = case.succeeds(classify);
    assert!(!said.contains("one value for each class"), "{said}");
    let features = features();
    let rows = features.rows().into_iter().zip(labels());
    let rows = rows.map(|(row, label)| format!("{},{},{}\n", row[0], 7 - 2 * label, row[1]));
    case.remove("features.npy");
    case.file(
        "features.csv",
        format!("mean,label,std\n{}", rows.collect::<String>()),
    );
    let (_, said) = case.succeeds(classify);
    let note = "note: .: column 2 of the features has one value for each class; remove it if it is the label";
    says(&said, &[note]);
}
