//! Readings of simulated skins, used as recordings, give the results of the simulated study.

use super::{SKIN, has_errors};
use crate::command::Case;
use crate::study::Study;
use bubbletouch::kinds::recognition::RecognitionStudy;
use bubbletouch::sensing::Ensemble;
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::TrialScore;
use bubbletouch::study::{StudySpec, simulate_array};
use ndarray::{Array, Array1, Array4, Axis, Dimension};

const OBJECTS: &str = include_str!("../../fixtures/texts/recorded_objects.toml");

const REST: &str = include_str!("../../fixtures/texts/recorded_rest.toml");

const FILES: &str = "frames = \"frames.npy\"\nlabels = \"labels.npy\"\n";

/// Loads the study of the files of a folder, with further keys of `[recorded]`.
fn study(case: &Case, more: &str, rest: &str) -> RecognitionStudy {
    let study = case.recorded(&format!("{FILES}{more}"), &format!("{SKIN}{rest}"));
    study.unwrap()
}

fn scores(study: &RecognitionStudy) -> Vec<TrialScore> {
    let rows = study.run(&Silent).unwrap().accuracy.into_iter();
    rows.map(|(_, score)| score).collect()
}

/// Returns a study without noise, the labels of its touches, and their frames of n × 2 × 8 × 8, metres.
fn simulated() -> (Study, Vec<usize>, Array4<f32>) {
    let head = "question = \"?\"\ntrials = 2\n";
    let study = Study::new(&format!("{head}{SKIN}taxels = 8\n{OBJECTS}{REST}"));
    let frames = simulate_array(&study.touched, &study.plan.array, 2, &Silent);
    let frames = frames.to_array().mapv(|metres| metres as f32);
    let labels = study.sweep.labels.to_vec();
    let shape = (labels.len(), 2, 8, 8);
    let frames = frames.into_shape_with_order(shape).unwrap();
    (study, labels, frames)
}

/// Creates a folder with frames and labels.
fn written<D: Dimension>(frames: &Array<f32, D>, labels: &[usize]) -> Case {
    let case = Case::new();
    case.write_array("frames.npy", frames);
    case.write_integers("labels.npy", labels.to_vec());
    case
}

#[test]
fn counts_of_our_own_skin_are_recognised_as_that_study_recognises_its_deflections() {
    let (simulated, labels, frames) = simulated();
    let expected = scores(&simulated.of_items());
    assert!(has_errors(&expected), "{expected:?}");
    // In counts of a converter with the zero 100, the skin is the same up to the last digits.
    let case = written(&frames.mapv(|metres| 100.0 + 65536.0 * metres), &labels);
    let names = "names = [\"golf\", \"tennis\", \"baseball\"]\n";
    let counted = study(
        &case,
        &format!("{names}zero = 100.0\nfull_scale = 427.68"),
        REST,
    );
    assert_eq!(scores(&counted), expected);
}

#[test]
fn touches_may_come_in_any_order_and_groups_are_held_out_whole() {
    let (_, labels, frames) = simulated();
    let n = labels.len();
    let order: Vec<usize> = (0..n).map(|k| k * 5 % n).rev().collect();
    let labels: Vec<usize> = order.iter().map(|&touch| labels[touch]).collect();
    let case = written(&frames.select(Axis(0), &order), &labels);
    // The first taxel of each touch contains the number of its group.
    let group = |touch: usize| 7 + touch % 6;
    case.write_integers("groups.npy", (0..n).map(group));
    let study = study(&case, "groups = \"groups.npy\"\n", REST);
    let part = study.first();
    assert_eq!(part.touched.classes()[0], ("class 0", 12));
    let keys = part.sweep.group_keys.as_ref().unwrap();
    let mut in_order: Vec<usize> = (0..n).collect();
    in_order.sort_by_key(|&touch| labels[touch]);
    let in_order: Vec<usize> = in_order.into_iter().map(group).collect();
    assert_eq!(keys.to_vec(), in_order);
    for split in &part.sweep.splits {
        assert!(!split.test.is_empty());
        for test in &split.test {
            assert!(split.train.iter().all(|train| keys[*train] != keys[*test]));
        }
    }
    study.run(&Silent).unwrap();
}

#[test]
fn without_sensing_all_taxels_are_measured() {
    let (_, labels, frames) = simulated();
    let case = written(&frames, &labels);
    let run = |rest: &str| study(&case, "", rest).run(&Silent).unwrap();
    let rest = "[recognition]\nclassifier = \"linear_svm\"\n";
    let named = run(&format!("[sensing]\nensemble = \"identity\"\n{rest}"));
    let default = run(rest);
    assert_eq!(default.accuracy, named.accuracy);
    assert_eq!(default.summary[0].0.measurements, 64);
    // An axis of the table keeps the default ensemble of the table.
    let compressed = run(&format!("{rest}[axes]\n\"sensing.ratio\" = [4.0]\n"));
    let of = &compressed.summary[0].0;
    assert_eq!((of.ensemble, of.measurements), (Ensemble::Gaussian, 16));
}

#[test]
fn an_array_of_any_sides_is_measured_by_every_ensemble() {
    let frames = Array::from_shape_fn((40, 7, 12), |(touch, row, column)| {
        let (class, wave) = (touch % 2, (touch * 13 + row * 5 + column * 3) % 11);
        (if class == 0 { row } else { column }) as f32 + 0.1 * wave as f32
    });
    let case = written(&frames, &(0..40).map(|touch| touch % 2).collect::<Vec<_>>());
    let rest = "[sensing]\nensemble = [\"gaussian\", \"bernoulli\", \"sbhe\", \"block_average\", \"subsample\", \"identity\"]\nmeasurements = 12\n[recognition]\nclassifier = \"linear_svm\"\n";
    let tables = study(&case, "", rest).run(&Silent).unwrap();
    assert_eq!(tables.summary.len(), 6);
    for (of, summary) in &tables.summary {
        assert_eq!((of.nx, of.ny), (12, 7));
        assert!(
            summary.accuracy > 0.7,
            "{:?}: {}",
            of.ensemble,
            summary.accuracy
        );
    }
    // The largest reading is the full scale: at least one touch reaches it, and none exceeds it.
    let missed: Vec<u64> = tables.limits.iter().map(|limit| limit.count).collect();
    assert_eq!(missed[..2], [0, 0]);
}

#[test]
fn folds_without_trials_have_a_trial_each() {
    for (trials, expected) in [("", 4), ("trials = 8\n", 8), ("trials = 1\n", 1)] {
        let text = format!(
            "question = \"?\"\n{trials}[recorded]\n{FILES}[recognition]\nclassifier = \"linear_svm\"\nfolds = 4\n{SKIN}"
        );
        let spec = StudySpec::parse("study.toml", &text).unwrap();
        assert_eq!(spec.trials, expected);
    }
}

/// Creates a folder of six frames of 4 × 5 taxels, beside files that do not fit them.
pub fn small() -> Case {
    let mut frames = Array::from_shape_fn((6, 4, 5), |(n, row, column)| (n + row * column) as f32);
    let case = written(&frames, &[0, 1, 0, 1, 0, 1]);
    case.write_integers("five_labels.npy", [0, 1, 0, 1, 0]);
    case.write_integers("one_class.npy", [0; 6]);
    case.write_array("one_axis.npy", &Array1::<f32>::zeros(6));
    frames[[3, 1, 2]] = f32::INFINITY;
    case.write_array("infinite.npy", &frames);
    case
}

#[test]
fn recordings_of_one_class_each_are_divided_into_folds() {
    // Four classes, five recordings of each, four frames a recording.
    let frames = Array::from_shape_fn((80, 4, 4), |(frame, row, _)| match frame / 20 == row {
        true => 1e-3,
        false => 1e-4 * (frame % 3) as f32,
    });
    let case = written(
        &frames,
        &(0..80).map(|frame| frame / 20).collect::<Vec<_>>(),
    );
    case.write_integers("groups.npy", (0..80).map(|frame| frame / 4));
    let recognition = "[recognition]\nclassifier = \"nearest_centroid\"\nfolds = 5";
    let recorded = format!("[recorded]\n{FILES}groups = \"groups.npy\"\n");
    let text = format!("question = \"?\"\ntrials = 5\n{recorded}{SKIN}{recognition}");
    for score in scores(&case.load_study(&text).unwrap()) {
        assert_eq!((score.n_test, score.n_train, score.accuracy), (16, 64, 1.0));
        assert_eq!(score.n_groups, Some(4));
    }
}
