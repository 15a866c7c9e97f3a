//! Tables of single decisions, of recall, and the further measures of recognition.

use crate::command::Case;
use crate::study::{Study, assert_reads_back, centroid_distances, laid_out, table};
use bubbletouch::recognition::data::dataset::dataset;
use bubbletouch::studies::recognition::charts::tables_of;
use bubbletouch::study::progress::Silent;
use bubbletouch::table::Table;
use ndarray::{Array1, Array3, Axis};
use std::collections::{BTreeMap, BTreeSet};

const STUDY: &str = include_str!("../fixtures/texts/predictions.toml");

const REPORT: &str = r#"
[report]
predictions = true
metrics = ["balanced_accuracy", "log_loss", "recall"]
"#;

fn tables(text: &str) -> BTreeMap<&'static str, Table> {
    let tables = tables_of(&Study::new(text).run()).unwrap().into_iter();
    tables.map(|table| (table.file, table)).collect()
}

#[test]
fn predictions_give_the_counts_and_measures_of_the_other_tables() {
    let found = tables(&format!("{STUDY}{REPORT}"));
    let (accuracy, predictions) = (&found["accuracy.csv"], &found["predictions.csv"]);
    let recall = &found["recall.csv"];
    let columns = predictions.columns.iter();
    let classes = columns.filter_map(|column| column.name.strip_prefix("score_"));
    let classes: Vec<&str> = classes.collect();
    assert_eq!(classes.len(), 4);
    let mut n_probabilistic = 0;
    for row in 0..accuracy.n_rows {
        let is_own = |other: &usize| {
            let mut columns = ["configuration", "trial"].iter();
            columns.all(|name| predictions.number(name, *other) == accuracy.number(name, row))
        };
        let own: Vec<usize> = (0..predictions.n_rows).filter(is_own).collect();
        assert_eq!(own.len() as f64, accuracy.number("n_test", row));
        let k = accuracy.number("touches_per_decision", row) as usize;
        let mut touches = BTreeSet::new();
        let (mut n_correct, mut losses) = (0, Vec::new());
        let mut of_class: BTreeMap<&str, [f64; 2]> = BTreeMap::new();
        for &one in &own {
            let named: Vec<&str> = predictions.word("touch", one).split(' ').collect();
            assert_eq!(named.len(), k);
            assert!(named.into_iter().all(|touch| touches.insert(touch)));
            let [truth, answer] = ["truth", "answer"].map(|name| predictions.word(name, one));
            let score = |class: &str| predictions.number(&format!("score_{class}"), one);
            let scores = classes.iter().map(|class| score(class));
            let most = scores.fold(f64::MIN, f64::max);
            let is_one_vs_one = accuracy.word("classifier", row).ends_with("_svm");
            // Classes of equal votes differ by less than 2 / 3.
            assert!(score(answer) >= most - if is_one_vs_one { 0.7 } else { 0.0 });
            let is_correct = truth == answer;
            n_correct += usize::from(is_correct);
            let counts = of_class.entry(truth).or_default();
            counts[0] += f64::from(u8::from(is_correct));
            counts[1] += 1.0;
            losses.push(-score(truth));
            let sum: f64 = classes.iter().map(|class| score(class).exp()).sum();
            if accuracy.number("log_loss", row).is_finite() {
                assert!((sum - 1.0).abs() < 1e-12, "{sum}");
            }
        }
        assert_eq!(n_correct as f64, accuracy.number("n_correct", row));
        let balanced = of_class.values().map(|[part, all]| part / all).sum::<f64>() / 4.0;
        let difference = balanced - accuracy.number("balanced_accuracy", row);
        assert!(difference.abs() < 1e-12, "{difference}");
        let log_loss = accuracy.number("log_loss", row);
        let classifier = accuracy.word("classifier", row);
        let has_none = classifier.ends_with("_svm") || classifier == "nearest_centroid";
        assert_eq!(log_loss.is_nan(), has_none);
        if !log_loss.is_nan() {
            n_probabilistic += 1;
            let mean = losses.iter().map(|loss: &f64| loss.min(-f64::EPSILON.ln()));
            let mean = mean.sum::<f64>() / losses.len() as f64;
            assert!((log_loss - mean).abs() < 1e-12, "{log_loss} {mean}");
        }
    }
    assert_eq!(n_probabilistic, 4 * 2 * 2);
    for row in 0..recall.n_rows {
        let is_own = |other: &usize| {
            predictions.number("configuration", *other) == recall.number("configuration", row)
                && predictions.word("truth", *other) == recall.word("object", row)
        };
        let own: Vec<usize> = (0..predictions.n_rows).filter(is_own).collect();
        let correct = own
            .iter()
            .filter(|&&one| predictions.word("truth", one) == predictions.word("answer", one));
        let expected = correct.count() as f64 / own.len() as f64;
        assert_eq!(recall.number("recall", row), expected);
    }
    assert_eq!(recall.n_rows, 7 * 2 * 4);
}

#[test]
fn a_study_that_asks_for_nothing_has_the_rows_of_one_that_asks_and_no_more_columns() {
    let (usual, asked) = (tables(STUDY), tables(&format!("{STUDY}{REPORT}")));
    assert!(!usual.contains_key("predictions.csv") && !usual.contains_key("recall.csv"));
    for file in ["accuracy.csv", "summary.csv", "confusion.csv"] {
        let (usual, asked) = (&usual[file], &asked[file]);
        assert!(usual.place("log_loss").is_none() && usual.place("balanced_accuracy").is_none());
        for (column, data) in usual.columns.iter().zip(&usual.data) {
            let other = asked.column(&column.name).unwrap().1;
            for row in 0..usual.n_rows {
                assert_eq!(data.value(row), other.value(row), "{file}, {}", column.name);
            }
        }
    }
}

#[test]
fn a_folder_gives_the_predictions_that_were_written() {
    let study = laid_out(&format!("{STUDY}{REPORT}")).unwrap();
    let made = tables_of(&study.run(&Silent).unwrap()).unwrap();
    assert!(table(&made, "predictions.csv").n_rows > 0);
    assert_reads_back(&study, &made);
}

#[test]
fn merged_shards_give_the_predictions_of_one_run() {
    let case = Case::with("study.toml", format!("{STUDY}{REPORT}"));
    case.succeeds("run study.toml --out whole");
    for shard in ["1/2", "2/2"] {
        case.succeeds(&["run", "study.toml", "--out", "parts", "--shard", shard]);
    }
    case.succeeds("merge study.toml --out parts");
    case.same_files(["whole", "parts"], &["predictions.csv", "recall.csv"]);
}

/// Study of the touches of [`mixed`].
const RECORDED: &str = include_str!("../fixtures/texts/recorded_splits.toml");

/// Writes touches in mixed order of their classes and groups.
fn mixed() -> Case {
    let case = Case::new();
    let label = |touch: usize| (touch * 7 + touch / 5) % 3;
    let frames = Array3::from_shape_fn((60, 6, 6), |(touch, row, column)| {
        let at = ((touch * 36 + row * 6 + column) * 7919 % 997) as f64 / 997.0;
        at + if column == label(touch) { 0.7 } else { 0.0 }
    });
    case.write_array("frames.npy", &frames);
    case.write_integers("labels.npy", (0..60).map(label));
    case.write_integers("groups.npy", (0..60).map(|touch| touch / 10));
    case
}

/// Training and test touches of a trial.
type Touches = [Vec<i64>; 2];

/// Writes an archive of the splits of all trials.
fn write_splits(case: &Case, name: &str, splits: &[Touches]) {
    let mut archive = case.archive(name);
    for (trial, [train, test]) in splits.iter().enumerate() {
        for (side, touches) in [("train", train), ("test", test)] {
            let touches = Array1::from(touches.clone());
            archive
                .add_array(format!("{side}_{trial}"), &touches)
                .unwrap();
        }
    }
    archive.finish().unwrap();
}

/// Creates a folder of recorded touches with splits that do not fit them.
pub fn with_wrong_splits() -> Case {
    let case = mixed();
    let whole = || [(20..60).collect(), (0..20).collect()];
    let write = |name: &str, splits: &[Touches]| write_splits(&case, name, splits);
    write("splits.npz", &[whole(), whole()]);
    write("one.npz", &[whole()]);
    write("beyond.npz", &[[vec![60], vec![0]]]);
    write("twice.npz", &[[vec![20, 20], vec![0]]]);
    write("both.npz", &[[vec![20, 0], vec![0]]]);
    write("group.npz", &[[(15..60).collect(), (0..15).collect()]]);
    write("none.npz", &[]);
    case
}

/// Returns the predictions of a study of recorded touches.
fn predictions_of(case: &Case, study: &str) -> Table {
    let tables = case.load_study(study).unwrap().run(&Silent).unwrap();
    table(&tables_of(&tables).unwrap(), "predictions.csv").clone()
}

#[test]
fn predictions_of_own_splits_name_the_touches_of_the_file() {
    let case = mixed();
    // Two groups are held out in each trial; touches 0 to 9 are left out of the second.
    let splits: [Touches; 2] = [
        [(20..60).collect(), (0..20).rev().collect()],
        [(10..40).collect(), (40..60).collect()],
    ];
    write_splits(&case, "splits.npz", &splits);
    let predictions = predictions_of(&case, RECORDED);
    let labels: Array1<i64> = case.read_array("labels.npy");
    let frames: Array3<f64> = case.read_array("frames.npy");
    let frames = frames.into_shape_with_order((60, 36)).unwrap();
    for (trial, [train, test]) in splits.iter().enumerate() {
        let is_own = |row: &usize| predictions.number("trial", *row) == trial as f64;
        let own: Vec<usize> = (0..predictions.n_rows).filter(is_own).collect();
        let touch = |row: usize| -> i64 { predictions.word("touch", row).parse().unwrap() };
        let touches: BTreeSet<i64> = own.iter().map(|&row| touch(row)).collect();
        assert_eq!(own.len(), test.len());
        assert_eq!(touches, test.iter().copied().collect());
        // The answers are those of a nearest centroid on the standardised touches of the file.
        let train: Vec<usize> = train.iter().map(|&touch| touch as usize).collect();
        let of_train = labels.select(Axis(0), &train).mapv(|label| label as usize);
        let training = dataset(frames.select(Axis(0), &train), of_train).unwrap();
        let distances = centroid_distances(&training, &frames);
        for row in own {
            let number = touch(row);
            let truth = format!("class {}", labels[number as usize]);
            assert_eq!(predictions.word("truth", row), truth);
            assert_eq!(predictions.word("group", row), (number / 10).to_string());
            let distance = |class: &usize| distances[[number as usize, *class]];
            let nearest = (0..3).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let nearest = nearest.unwrap();
            assert_eq!(predictions.word("answer", row), format!("class {nearest}"));
            let score = predictions.number(&format!("score_class {nearest}"), row);
            assert!((score + 0.5 * distance(&nearest)).abs() < 1e-4 * distance(&nearest));
        }
    }
}

#[test]
fn predictions_name_the_groups_as_their_file_does() {
    let case = mixed();
    let name = |touch: usize| format!("subject{}", (touch / 10 + 3) % 6);
    let lines: String = (0..60).map(|touch| name(touch) + "\n").collect();
    case.file("groups.csv", lines);
    let study = RECORDED.replace("splits = \"splits.npz\"\n", "");
    let predictions = predictions_of(&case, &study.replace("groups.npy", "groups.csv"));
    assert!(predictions.n_rows >= 10);
    for row in 0..predictions.n_rows {
        let touch: usize = predictions.word("touch", row).parse().unwrap();
        assert_eq!(predictions.word("group", row), name(touch));
    }
}
