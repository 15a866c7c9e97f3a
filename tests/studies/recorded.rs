//! Studies of recorded frames: readings of simulated skins, used as recordings, give the results of the simulated study.

use crate::command::{Case, says};
use crate::study::{Study, laid_out};
use bubbletouch::kinds::recognition::RecognitionStudy;
use bubbletouch::sensing::Ensemble;
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::TrialScore;
use bubbletouch::study::{simulate_array, write_integers, write_npy};
use ndarray::{Array, Array1, Array4, Dimension};
use std::path::Path;

const OBJECTS: &str = include_str!("../fixtures/texts/recorded_objects.toml");

const REST: &str = include_str!("../fixtures/texts/recorded_rest.toml");

const HEAD: &str = "question = \"?\"\ntrials = 2\n";
const SKIN: &str = "[skin]\npitch_mm = 4.0\nstroke_mm = 5.0\n";

fn recorded(folder: &Path, more: &str, rest: &str) -> String {
    let path = |name: &str| folder.join(name).display().to_string();
    let (frames, labels) = (path("frames.npy"), path("labels.npy"));
    format!("{HEAD}{SKIN}[recorded]\nframes = {frames:?}\nlabels = {labels:?}\n{more}\n{rest}")
}

fn scores(study: &RecognitionStudy) -> Vec<TrialScore> {
    let tables = study.run(&Silent).unwrap();
    tables
        .accuracy
        .into_iter()
        .map(|(_, score)| score)
        .collect()
}

/// Returns the readings of the study above without noise: labels, and frames of n × 2 × 8 × 8, metres.
fn simulated() -> (Study, Vec<usize>, Array4<f32>) {
    let study = Study::new(&format!("{HEAD}{SKIN}taxels = 8\n{OBJECTS}{REST}"));
    let frames = simulate_array(&study.touched, &study.plan.arrays[0], 2, &Silent);
    let frames = frames.to_array().mapv(|metres| metres as f32);
    let labels = study.sweep.labels.to_vec();
    let frames = frames
        .into_shape_with_order((labels.len(), 2, 8, 8))
        .unwrap();
    (study, labels, frames)
}

fn write<D: Dimension>(folder: &Path, frames: &Array<f32, D>, labels: &[usize]) {
    write_npy(&folder.join("frames.npy"), frames).unwrap();
    write_integers(&folder.join("labels.npy"), labels.to_vec()).unwrap();
}

#[test]
fn frames_of_our_own_skin_are_recognised_as_that_study_recognises_them_to_the_bit() {
    let case = Case::new();
    let (study, labels, frames) = simulated();
    write(case.folder(), &frames, &labels);
    let names = "names = [\"golf\", \"tennis\", \"baseball\"]\nfull_scale = 5e-3";
    let replayed = laid_out(&recorded(case.folder(), names, REST)).unwrap();
    let expected = scores(&study.of_items());
    assert_eq!(scores(&replayed), expected);
    // Some predictions are wrong; otherwise, the comparison would be trivial.
    assert!(
        expected.iter().any(|score| score.n_correct < score.n_test),
        "{expected:?}"
    );
    // In counts of a converter with the zero 100, the skin is the same up to the last digits.
    let counts = frames.mapv(|metres| 100.0 + 65536.0 * metres);
    write(case.folder(), &counts, &labels);
    let counted = "zero = 100.0\nfull_scale = 427.68\nnames = [\"golf\", \"tennis\", \"baseball\"]";
    let counted = laid_out(&recorded(case.folder(), counted, REST)).unwrap();
    assert_eq!(scores(&counted), expected);
}

#[test]
fn touches_may_come_in_any_order_and_groups_are_held_out_whole() {
    let case = Case::new();
    let (_, labels, frames) = simulated();
    let n = labels.len();
    let order: Vec<usize> = (0..n).map(|k| k * 5 % n).rev().collect();
    let frames = frames.select(ndarray::Axis(0), &order);
    let labels: Vec<usize> = order.iter().map(|&touch| labels[touch]).collect();
    write(case.folder(), &frames, &labels);
    // The first taxel of each touch contains the number of its group.
    let groups: Vec<usize> = (0..n).map(|touch| 7 + touch % 6).collect();
    write_integers(&case.folder().join("groups.npy"), groups.clone()).unwrap();
    let path = case.folder().join("groups.npy").display().to_string();
    let text = recorded(case.folder(), &format!("groups = {path:?}"), REST);
    let study = laid_out(&text).unwrap();
    let part = study.first();
    assert_eq!(part.touched.classes()[0], ("class 0", 12));
    let keys = part.sweep.group_keys.as_ref().unwrap();
    let in_order = (0..3).flat_map(|label| {
        let of_class = labels
            .iter()
            .zip(&groups)
            .filter(move |(own, _)| **own == label);
        of_class.map(|(_, group)| *group)
    });
    assert_eq!(keys.to_vec(), in_order.collect::<Vec<_>>());
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
    let case = Case::new();
    let (_, labels, frames) = simulated();
    write(case.folder(), &frames, &labels);
    let run = |rest: &str| {
        let study = laid_out(&recorded(case.folder(), "", rest)).unwrap();
        study.run(&Silent).unwrap()
    };
    let rest = "[recognition]\nclassifier = \"linear_svm\"\n";
    let (named, default) = (
        run(&format!("[sensing]\nensemble = \"identity\"\n{rest}")),
        run(rest),
    );
    assert_eq!(default.accuracy, named.accuracy);
    assert_eq!(default.summary[0].0.measurements, 64);
    // An axis of the table keeps the default ensemble of the table.
    let compressed = run(&format!("{rest}[axes]\n\"sensing.ratio\" = [4.0]\n"));
    let configuration = &compressed.summary[0].0;
    assert_eq!(
        (configuration.ensemble, configuration.measurements),
        (Ensemble::Gaussian, 16)
    );
}

#[test]
fn an_array_of_any_sides_is_measured_by_every_ensemble() {
    let case = Case::new();
    let frames = Array::from_shape_fn((40, 7, 12), |(touch, row, column)| {
        let (class, wave) = (touch % 2, (touch * 13 + row * 5 + column * 3) % 11);
        (if class == 0 { row } else { column }) as f32 + 0.1 * wave as f32
    });
    let labels: Vec<usize> = (0..40).map(|touch| touch % 2).collect();
    write(case.folder(), &frames, &labels);
    let ensembles =
        "[\"gaussian\", \"bernoulli\", \"sbhe\", \"block_average\", \"subsample\", \"identity\"]";
    let rest = format!(
        "[sensing]\nensemble = {ensembles}\nmeasurements = 12\n[recognition]\nclassifier = \"linear_svm\"\n"
    );
    let study = laid_out(&recorded(case.folder(), "", &rest)).unwrap();
    let tables = study.run(&Silent).unwrap();
    assert_eq!(tables.summary.len(), 6);
    for (configuration, summary) in &tables.summary {
        assert_eq!((configuration.nx, configuration.ny), (12, 7));
        assert!(
            summary.accuracy > 0.7,
            "{:?}: {}",
            configuration.ensemble,
            summary.accuracy
        );
    }
    // The largest reading is the full scale: at least one touch reaches it, and none exceeds it.
    let missed = tables
        .limits
        .iter()
        .map(|limit| limit.count)
        .collect::<Vec<_>>();
    assert_eq!(missed[..2], [0, 0]);
}

#[test]
fn folds_without_trials_have_a_trial_each() {
    let with = |trials: &str| {
        let text = format!(
            "question = \"?\"\n{trials}[recorded]\nframes = \"f.npy\"\n[recognition]\nclassifier = \"linear_svm\"\nfolds = 4\n[skin]\npitch_mm = 1.0\nstroke_mm = 1.0\n"
        );
        bubbletouch::study::StudySpec::parse("study.toml", &text)
            .unwrap()
            .trials
    };
    assert_eq!(
        (with(""), with("trials = 8\n"), with("trials = 1\n")),
        (4, 8, 1)
    );
}

#[test]
fn what_does_not_fit_is_refused_by_its_name() {
    let case = Case::new();
    let folder = case.folder();
    let frames = Array::from_shape_fn((6, 4, 5), |(n, row, column)| (n + row * column) as f32);
    let labels = [0, 1, 0, 1, 0, 1];
    let said = |more: &str, rest: &str| {
        let text = recorded(folder, more, rest);
        laid_out(&text).err().expect("it is refused").to_string()
    };
    let refused = |more: &str, expected: &str| {
        let said = said(more, REST);
        assert!(said.contains(expected), "{said}\ndoes not say {expected}");
    };
    refused("", "frames.npy: cannot be read");
    write(folder, &frames, &labels);
    refused("zero = nan", "key recorded.zero: NaN");
    refused(
        "full_scale = 0.0",
        "key recorded.full_scale: 0; a number other than recorded.zero",
    );
    refused(
        "names = [\"a\"]",
        "key recorded.names: 1 names; 2, one a class",
    );
    refused("names = [\"a\", \"a\"]", "key recorded.names: \"a\" twice");
    refused("zero = 100.0", "no reading above recorded.zero, 100");
    refused("groups = \"nowhere.npy\"", "nowhere.npy");
    refused(
        "[objects]\nsets = [\"balls\"]",
        "key recorded: beside [objects]",
    );
    refused(
        "[touches]\ndepth_mm = 1.0",
        "key recorded: beside [objects]",
    );
    let grouped = REST.replace("classifier", "group_by = \"pose\"\nclassifier");
    assert!(said("", &grouped).contains("recorded.groups says"));
    let sided = recorded(folder, "", REST).replace("stroke_mm", "taxels = 4\nstroke_mm");
    let sided = laid_out(&sided).err().unwrap().to_string();
    says(&sided, &["key skin.taxels: given"]);
    write(folder, &frames, &labels[..5]);
    refused("", "labels.npy: 5 values; 6, one a touch");
    write(folder, &frames, &[0; 6]);
    refused("", "at least two, since recognition tells classes apart");
    write(folder, &Array1::<f32>::zeros(6), &labels);
    refused("", "frames.npy: an array of shape [6]; n × rows × columns");
    let mut broken = frames;
    broken[[3, 1, 2]] = f32::INFINITY;
    write(folder, &broken, &labels);
    refused("", "frames.npy, frame 3, taxel 7: inf; a finite number");
}

#[test]
fn recordings_of_one_class_each_are_divided_into_folds() {
    // Four classes, five recordings of each, four frames a recording.
    let folder = Case::new();
    let frames = Array::from_shape_fn((80, 4, 4), |(frame, row, _)| {
        if frame / 20 == row {
            1e-3
        } else {
            1e-4 * (frame % 3) as f32
        }
    });
    let labels: Vec<usize> = (0..80).map(|frame| frame / 20).collect();
    write(folder.folder(), &frames, &labels);
    write_integers(
        &folder.path("groups.npy"),
        (0..80).map(|frame| frame / 4).collect::<Vec<usize>>(),
    )
    .unwrap();
    let groups = format!(
        "groups = {:?}",
        folder.path("groups.npy").display().to_string()
    );
    let text = recorded(
        folder.folder(),
        &groups,
        "[recognition]\nclassifier = \"nearest_centroid\"\nfolds = 5",
    );
    let study = laid_out(&text.replace("trials = 2", "trials = 5")).unwrap();
    for score in scores(&study) {
        assert_eq!((score.n_test, score.n_train, score.accuracy), (16, 64, 1.0));
        assert_eq!(score.n_groups, Some(4));
    }
}
