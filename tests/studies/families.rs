//! Tests of features, frames per touch, decisions on several touches, and the choice of C and γ. The results are compared with laws and with a slow pipeline
//! that processes one touch after the other.

use crate::study::{Study, accuracies, pressed, trials_of};
use bubbletouch::kinds::recognition::recognition_scale;
use bubbletouch::random::Seed;
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::recognition::classifiers::classifier::{Classifier, Cost, TrainedClassifier};
use bubbletouch::recognition::classifiers::foreign::{Foreign, ForeignClassifier, ForeignModel};
use bubbletouch::recognition::data::dataset::{Dataset, dataset};
use bubbletouch::recognition::evaluation::fusion::fuse_rows;
use bubbletouch::recognition::features::Features;
use bubbletouch::recognition::svm;
use bubbletouch::sensing::Projection;
use bubbletouch::signal::{Chain, Noise, NoiseUnit, SignalStep, SignalWorkspace};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::simulate_array;
use bubbletouch::study::table::{Configuration, Tables, TrialScore};
use ndarray::{Array1, Array2, ArrayView2, Axis};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

const STUDY: &str = include_str!("../fixtures/texts/families.toml");

/// Returns the study with additional lines in its tables.
fn with(touches: &str, recognition: &str) -> String {
    STUDY
        .replace("[touches]", &format!("[touches]\n{touches}"))
        .replace("[recognition]", &format!("[recognition]\n{recognition}"))
}

const ALL_FEATURES: &str = r#"features = ["raw", "centred", "unit_norm", "centred_unit_norm"]"#;

/// Computes the feature rows of a configuration in a trial with plain loops over touches, frames and numbers.
fn slow_rows(study: &Study, configuration: &Configuration, trial: u64) -> Array2<f64> {
    let array = &study.plan.array;
    let seed = Seed::new(study.plan.spec.seed);
    let steps = [SignalStep::Noise(Noise {
        std: configuration.noise_std,
        unit: NoiseUnit::FullScale,
    })];
    let chain = Chain::new(&steps, array.patch()).unwrap();
    let projection = Projection::new(
        configuration.ensemble,
        array.shape(),
        configuration.measurements,
        &seed.named("projection").numbered(trial),
    )
    .unwrap();
    let matrix = projection.matrix();
    let (m, depths) = (configuration.measurements, configuration.frames);
    let mut rows = Array2::zeros((study.sweep.labels.len(), depths * m));
    let features = configuration.features;
    let u = matrix.sum_axis(Axis(1));
    for (row, (object, touch)) in study.touches().into_iter().enumerate() {
        let number = row % object.touches.len();
        let name = seed.named("signal").numbered(trial);
        let name = name.named(&object.object.name).numbered(number as u64);
        for frame in 1..=depths {
            let depth = touch.depth * (frame as f64 / depths as f64);
            let (_, mut values) = pressed(array, (object, touch), depth);
            let noise = match frame == depths {
                true => name,
                false => name.named("frame").numbered(frame as u64),
            };
            chain.apply(&mut values, None, &noise, &mut SignalWorkspace::default());
            let values = Array1::from(values);
            let columns = (frame - 1) * m..frame * m;
            let mut part = rows.slice_mut(ndarray::s![row, columns]);
            for k in 0..m {
                part[k] = matrix.row(k).dot(&values);
            }
            if matches!(features, Features::Centred | Features::CentredUnitNorm) {
                let share = u.dot(&part) / u.dot(&u);
                part.zip_mut_with(&u, |y, u| *y -= share * u);
            }
        }
        if matches!(features, Features::UnitNorm | Features::CentredUnitNorm) {
            let norm = rows.row(row).iter().map(|v| v * v).sum::<f64>().sqrt();
            rows.row_mut(row).mapv_inplace(|v| v / norm);
        }
    }
    rows
}

/// Trains a classifier on the slow rows; also returns the test rows with their labels.
fn slow_fit(
    study: &Study,
    configuration: &Configuration,
    trial: usize,
) -> (TrainedClassifier, Array2<f64>, Array1<usize>) {
    let rows = slow_rows(study, configuration, trial as u64);
    let split = &study.sweep.splits[trial];
    let labels = |rows: &[usize]| study.sweep.labels.select(Axis(0), rows);
    let training = dataset(rows.select(Axis(0), &split.train), labels(&split.train)).unwrap();
    let classifier = Classifier {
        c: Cost::Fixed(configuration.c.unwrap()),
        ..Classifier::new(configuration.classifier)
    };
    let trained = classifier.train(&training, &Seed::new(0)).unwrap();
    let test = rows.select(Axis(0), &split.test);
    (trained, test, labels(&split.test))
}

fn n_equal(a: &Array1<usize>, b: &Array1<usize>) -> usize {
    a.iter().zip(b).filter(|(a, b)| a == b).count()
}

#[test]
fn frames_and_features_are_what_a_slow_pipeline_makes_of_each_touch() {
    let study = Study::new(&with("frames = [1, 3]", ALL_FEATURES));
    let outcome = study.run();
    assert_eq!(outcome.accuracy.len(), 2 * 4 * 2);
    for (configuration, score) in &outcome.accuracy {
        let (trained, test, truth) = slow_fit(&study, configuration, score.trial);
        let n_correct = n_equal(&trained.labels(test.view()).unwrap(), &truth);
        // Sums in another order can change the label of a row that is close to two objects.
        let n_other = n_correct.abs_diff(score.n_correct);
        assert!(n_other <= 1, "{configuration:?}: {n_correct} for {score:?}");
        assert_eq!((score.n_test, score.n_left_out), (truth.len(), 0));
    }
}

#[test]
fn fused_touches_are_decided_on_by_the_sum_of_their_scores() {
    let study = Study::new(&with("", "touches_per_decision = [1, 2, 5]"));
    let outcome = study.run();
    for (configuration, score) in &outcome.accuracy {
        let (trained, test, truth) = slow_fit(&study, configuration, score.trial);
        let scores = trained.scores(test.view()).unwrap();
        if configuration.touches_per_decision == 1 {
            let labels = trained.labels(test.view()).unwrap();
            assert_eq!(labels, trained.labels_of_scores(scores.view()));
        }
        let seed = Seed::new(2018).named("fused_touches");
        let seed = seed.numbered(score.trial as u64);
        let fused = fuse_rows(truth.view(), configuration.touches_per_decision, &seed);
        let mut n_correct = 0;
        for group in &fused.groups {
            let sum = scores.select(Axis(0), group).sum_axis(Axis(0));
            let label = trained.labels_of_scores(sum.insert_axis(Axis(0)).view())[0];
            n_correct += usize::from(label == truth[group[0]]);
        }
        let n_other = n_correct.abs_diff(score.n_correct);
        assert!(n_other <= 1, "{configuration:?}");
        // Twelve test touches for each of six objects.
        let k = configuration.touches_per_decision;
        let (n_groups, n_left) = (6 * (12 / k), 6 * (12 % k));
        assert_eq!((score.n_test, score.n_left_out), (n_groups, n_left));
    }
}

#[test]
fn cells_that_differ_in_fused_touches_share_one_fit_and_all_c_are_trained_together() {
    let keys = "touches_per_decision = [1, 2, 4]\nc = [0.1, 1.0]";
    let study = Study::new(&with("", keys));
    let groups = &study.sweep.groups;
    assert_eq!(groups.iter().flat_map(|g| g.families()).count(), 1);
    assert_eq!(study.sweep.n_configurations(), 6);
    let outcome = study.run();
    let mut fits: BTreeMap<(usize, String), Vec<u64>> = BTreeMap::new();
    for (configuration, time) in &outcome.timing {
        let key = (time.trial, format!("{:?}", configuration.c));
        fits.entry(key).or_default().push(time.fit_s.to_bits());
    }
    assert_eq!(fits.len(), 4);
    // Two separate measurements would not give the same nanosecond.
    let mut distinct = BTreeSet::new();
    for times in fits.values() {
        assert!(times.len() == 3 && times.iter().all(|t| *t == times[0]));
        distinct.insert(times[0]);
    }
    // The C of each trial share one training, in equal parts.
    assert_eq!(distinct.len(), 2);
}

#[test]
fn a_cell_does_not_depend_on_the_other_values_of_these_axes() {
    let alone = Study::new(&with("", "")).run();
    let keys = "features = [\"unit_norm\", \"raw\"]\ntouches_per_decision = [3, 1]\nc = [0.1, 1.0]";
    let among = Study::new(&with("frames = [2, 1]", keys)).run();
    let own = &alone.accuracy[0].0;
    let expected: Vec<&TrialScore> = alone.accuracy.iter().map(|(_, s)| s).collect();
    assert_eq!(expected.len(), 2);
    assert_eq!(trials_of(&among, own), expected);
    assert_eq!((own.frames, own.touches_per_decision), (1, 1));
}

#[test]
fn touching_again_recognises_more_in_noise() {
    let text = with("", "touches_per_decision = [1, 2, 6]")
        .replace("trials = 2", "trials = 4")
        .replace("full_scale = 0.2", "full_scale = 0.1");
    let summary = Study::new(&text).run().summary;
    let [one, two, six] = [(0, 1), (1, 2), (2, 6)].map(|(row, touches_per_decision)| {
        let (configuration, score) = &summary[row];
        assert_eq!(configuration.touches_per_decision, touches_per_decision);
        score.accuracy
    });
    assert!(two > one && six > one + 0.1, "{one} {two} {six}");
}

#[test]
fn a_choice_by_some_of_the_touches_does_not_see_the_others() {
    let keys = "c_grid = [0.01, 1.0]\ncv_touches = 5\ncv_folds = 5";
    let few = Study::new(&with("", &format!("{keys}\ntrain_touches = 5"))).run();
    let many = Study::new(&with("", &format!("{keys}\ntrain_touches = [5, 20]"))).run();
    let chosen = |outcome: &Tables, touches: usize| -> Vec<Option<f64>> {
        let rows = outcome.accuracy.iter();
        let rows = rows.filter(|(of, _)| of.train_touches == touches);
        rows.map(|(_, score)| score.c_used).collect()
    };
    // The five touches of a smaller training set are the first of a larger one.
    assert_eq!(chosen(&few, 5), chosen(&many, 5));
    assert_eq!(chosen(&many, 20), chosen(&many, 5));
}

#[test]
fn frames_take_memory_in_proportion() {
    let bytes = |frames: usize| {
        let text = with(&format!("frames = {frames}"), "");
        let many = text.replace("per_object = 32", "per_object = 60000");
        recognition_scale(&Study::new(&many).of_items()).stages[0].bytes
    };
    // At least a bit for each of 256 taxels, and at most a number, too.
    let more = (bytes(4) - bytes(1)) / (3.0 * 6.0 * 60_000.0);
    assert!((32.0..1100.0).contains(&more), "{more}");
}

#[test]
fn the_size_of_frames_is_estimated_from_some_touches() {
    let study = Study::new(STUDY);
    let array = &study.plan.array;
    let frames = simulate_array(&study.touched, array, 1, &Silent).to_array();
    let n_touched = frames.iter().filter(|value| **value > 0.0).count();
    let actual = array.n_values() as f64 / 8.0 + 4.0 * n_touched as f64 / frames.nrows() as f64;
    let estimated = study.of_items().first().touched.frame_bytes((array, 1));
    let error = estimated / actual - 1.0;
    assert!(error.abs() < 0.2, "{estimated} for {actual}");
}

#[test]
fn keys_of_trees_and_neighbours_reach_them() {
    let accuracy = |classifier: &str, keys: &str| {
        let new = format!("classifier = \"{classifier}\"\n{keys}");
        let quiet = STUDY.replace("noise_std_full_scale = 0.2", "noise_std_full_scale = 0.0");
        let study = Study::new(&quiet.replace("classifier = \"linear_svm\"", &new));
        let shares = accuracies(&study.run());
        shares.iter().sum::<f64>() / shares.len() as f64
    };
    // One split divides the six objects into two groups, so at most two objects are ever predicted.
    assert!(accuracy("random_forest", "n_trees = 1\nmax_depth = 1") <= 2.0 / 6.0);
    assert!(accuracy("random_forest", "n_trees = 1") > 2.0 / 6.0);
    assert!(accuracy("random_forest", "n_trees = 1") < accuracy("random_forest", "n_trees = 50"));
    // All rows vote, so every touch has the same label.
    let all = accuracy("k_nearest", "n_neighbours = 120");
    assert!((all - 1.0 / 6.0).abs() < 1e-12, "{all}");
    assert!(accuracy("k_nearest", "") > 2.0 / 6.0);
}

/// Classifier whose labels are never the most probable ones: it predicts the nearest mean, and its probabilities favour the farthest.
struct Contrary;

struct ContraryModel(TrainedClassifier);

impl ForeignClassifier for Contrary {
    fn fit(&self, rows: &Dataset, _: u32) -> Result<Box<dyn ForeignModel>, svm::Error> {
        let nearest = Classifier::new(ClassifierKind::NearestCentroid);
        Ok(Box::new(ContraryModel(nearest.train(rows, &0_u64)?)))
    }
}

impl ForeignModel for ContraryModel {
    fn predict(&self, rows: ArrayView2<f64>) -> Result<Vec<usize>, svm::Error> {
        Ok(self.0.labels(rows)?.to_vec())
    }

    fn log_probabilities(&self, rows: ArrayView2<f64>) -> Result<Option<Array2<f64>>, svm::Error> {
        Ok(Some(-self.0.scores(rows)?))
    }
}

#[test]
fn one_touch_is_always_predict() {
    let contrary = Foreign::new("contrary", "1").unwrap();
    let _provided = contrary.provide(Arc::new(Contrary));
    let accuracies = |k: &str| {
        let classifiers = "classifier = [\"contrary\", \"nearest_centroid\"]";
        let text = with("", &format!("touches_per_decision = {k}"));
        let text = text.replace("classifier = \"linear_svm\"", classifiers);
        let rows = Study::new(&text).run().accuracy;
        let of_one = rows.iter().filter(|(of, _)| of.touches_per_decision == 1);
        let accuracies: Vec<f64> = of_one.map(|(_, score)| score.accuracy).collect();
        accuracies
    };
    let alone = accuracies("1");
    assert_eq!(alone[..2], alone[2..], "the labels of the nearest mean");
    assert_eq!(accuracies("[1, 3]"), alone);
}
