//! Laws of recognition studies: configurations are independent, exports equal the run, and repetition does not increase significance.

use crate::study::{Study, features, laid_out, run, scores, table};
use bubbletouch::random::Seed;
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::recognition::classifiers::classifier::Classifier;
use bubbletouch::signal::{
    Chain, Recording, SENSOR_ERRORS, SensorError, SignalWorkspace, Strength,
};
use bubbletouch::studies::recognition::charts::{charts, tables_of};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::{PStatus, TrialScore};
use bubbletouch::study::{FeatureSet, StudySpec};
use bubbletouch::table::At;
use bubbletouch::world::{Grid, Patch, Taxel};
use std::collections::BTreeSet;

const STUDY: &str = include_str!("../fixtures/texts/laws.toml");

fn study(signal: &str, sensing: &str, recognition: &str) -> String {
    let text = STUDY.replace("SIGNAL", signal).replace("SENSING", sensing);
    text + recognition + "\n"
}

fn n_correct(set: &FeatureSet) -> usize {
    let classifier = Classifier::new(ClassifierKind::LinearSvm);
    let trained = classifier.train(&set.training(None).unwrap(), &Seed::new(0));
    let test = set.test().unwrap();
    let found = trained.unwrap().labels(test.records.view()).unwrap();
    let pairs = found.iter().zip(&test.targets);
    pairs.filter(|(found, truth)| found == truth).count()
}

/// Tests that exported rows give the answers of the run, also if a configuration trains on few touches.
#[test]
fn exported_rows_classified_elsewhere_give_the_answers_of_the_run() {
    let signal = "noise_std_full_scale = 0.1";
    let components = "ensemble = \"principal_components\"\nratio = 16";
    let few = "train_touches = [3, 18]";
    let tilted = format!("features = \"descriptors\"\ntilt_augmentation = 2\n{few}");
    for (sensing, recognition) in [
        (components, few),
        (components, "class_imbalance = [1.0, 6.0]"),
        ("ratio = 4", &tilted),
        ("ratio = 4", &format!("readings_per_touch = 2\n{few}")),
    ] {
        let study = laid_out(&study(signal, sensing, recognition)).unwrap();
        for (configuration, score) in study.run(&Silent).unwrap().accuracy {
            let cell = (configuration.configuration, score.trial);
            let set = study.first().features(cell, &Silent).unwrap();
            let what = format!("{recognition}, configuration and trial {cell:?}");
            assert_eq!(n_correct(&set), score.n_correct, "{what}");
        }
    }
}

/// Splits by pose repeat; without noise, their trials are equal.
#[test]
fn trials_that_repeat_splits_make_no_claim_stronger() {
    let text = |trials: usize, split: &str| {
        let recognition = format!("split = \"{split}\"");
        let text = study("steps = []", "ensemble = \"identity\"", &recognition);
        let text = text.replace("trials = 2", &format!("trials = {trials}"));
        let text = text.replace("\"linear_svm\"", "[\"linear_svm\", \"nearest_centroid\"]");
        let text = text.replace("{ uniform = [0.0, 360.0] }", "[0.0, 90.0, 180.0, 270.0]");
        text.replace("per_object = 24\n", "")
            .replace("{ uniform = [-10.0, 10.0] }", "{ grid = [-10.0, 10.0, 6] }")
    };
    let [twice, often] = [2, 12].map(|trials| run(&text(trials, "half_of_yaws")));
    for (twice, often) in twice.comparison.iter().zip(&often.comparison) {
        assert_eq!((often.n_trials, twice.n_trials), (2, 2));
        assert_eq!(often.p_status, PStatus::TooFewTrials);
        assert_eq!((often.p_value, often.n_trials_needed), (None, None));
    }
    for (trial, score) in scores(&often).iter().take(12).enumerate() {
        assert_eq!(score.distinct_split, Some(trial % 2));
    }
    for (_, score) in &often.summary {
        assert_eq!(score.bootstrap_low, None);
    }
    // Drawn splits are all different, so the table has no such column.
    let drawn = run(&text(6, "random"));
    let mut repeats = scores(&drawn).into_iter().map(|score| score.distinct_split);
    assert!(repeats.all(|split| split.is_none()));
    for row in &drawn.comparison {
        assert!(row.n_trials == 6 && row.p_value.is_some());
    }
}

#[test]
fn yaws_a_turn_apart_and_values_that_round_alike_are_one_pose() {
    let text = |yaws: &str, offsets: &str| {
        let split = "split = \"leave_one_yaw_out\"";
        let text = study("steps = []", "ensemble = \"identity\"", split);
        text.replace("{ uniform = [0.0, 360.0] }", yaws)
            .replace("{ uniform = [-10.0, 10.0] }", offsets)
            .replace("per_object = 24\n", "")
    };
    let (yaws, offsets) = ("[0.0, 90.0, 180.0, 270.0]", "[-0.3, 0.0, 0.3]");
    let plain = scores(&run(&text(yaws, offsets)));
    for (yaws, offsets) in [
        ("{ grid = [0.0, 360.0, 5] }", offsets),
        ("[0.0, 90.0, 180.0, 270.0, -90.0, -180.0, 450.0]", offsets),
        (yaws, "[-0.3, 0.0, 0.3, 0.30000000000000004]"),
    ] {
        let one = Study::new(&text(yaws, offsets));
        assert_eq!(one.sweep.labels.len(), 4 * 4 * 3, "{yaws} {offsets}");
        assert_eq!(scores(&one.run()), plain, "{yaws} {offsets}");
    }
}

#[test]
fn a_choice_among_one_value_is_that_value() {
    let signal = "noise_std_full_scale = 0.1";
    let fits = |keys: &str| {
        let text = study(signal, "ratio = 4", keys);
        let text = text.replace("\"linear_svm\"", "[\"linear_svm\", \"rbf_svm\"]");
        scores(&run(&text))
    };
    for scaling in ["none", "standard"] {
        let scaled = |keys: &str| fits(&format!("scaling = \"{scaling}\"\n{keys}"));
        let given = scaled("c = 10.0");
        for keys in [
            "c_grid = [10.0]\ncv_touches = 5",
            "c_grid = [10.0]\ncv_touches = 5\ncv_folds = 2",
            "c_grid = [10.0]\ngamma_grid = [1.0]\ncv_touches = 5",
            "c_grid = [10.0]",
        ] {
            assert_eq!(scaled(keys), given, "{scaling}: {keys}");
        }
    }
    let gammas = |scores: &[TrialScore]| -> Vec<f64> {
        scores.iter().filter_map(|score| score.gamma_used).collect()
    };
    // For standardised features, the default γ is 1 / m (m = 36), and a useless multiple of it is not chosen.
    for keys in [
        "c = 10.0",
        "c_grid = [10.0]\ngamma_grid = [1.0, 1e6]\ncv_folds = 3",
    ] {
        let found = gammas(&fits(keys));
        assert_eq!(found.len(), 2, "the trials of the RBF SVM");
        assert!(
            found.iter().all(|gamma| (36.0 * gamma - 1.0).abs() < 1e-9),
            "{found:?}"
        );
    }
    // If γ is chosen among several values, it is also a multiple of the default γ of all training rows.
    let rows = |keys: &str| fits(&format!("scaling = \"none\"\n{keys}"));
    let chosen = rows("c_grid = [1.0, 10.0]\ngamma_grid = [1.0, 2.0]\ncv_touches = 5");
    let scale = gammas(&rows("c = 10.0"));
    for (chosen, scale) in gammas(&chosen).iter().zip(&scale) {
        assert!([*scale, 2.0 * scale].contains(chosen), "{chosen} {scale}");
    }
}

#[test]
fn a_name_is_the_name_of_one_column() {
    let names = |keys: &str| -> Vec<String> {
        let axes = "\n[axes]\n\"recognition.split\" = [\"random\", \"half_of_yaws\"]\n";
        let text = study("steps = []", "ratio = 4", axes);
        let text = text.replace("trials = 2", &format!("trials = 4\n{keys}"));
        let spec = StudySpec::parse("study.toml", &text).unwrap();
        let columns = spec.axis_columns();
        let names = columns.iter().map(|column| column.name.to_string());
        names.collect()
    };
    assert_eq!(names(""), ["split"]);
    assert_eq!(names("projections_per_split = 2"), ["recognition_split"]);
}

#[test]
fn chance_is_that_of_each_configuration() {
    let axes = |sets: &str| {
        let axes = format!("\n[axes]\n\"objects.names\" = {sets}\n");
        let text = study("noise_std_full_scale = 0.1", "ratio = [4, 8]", &axes);
        let names = "names = [\"mug\", \"bowl\", \"apple\", \"pear\"]\n";
        let tables = tables_of(&run(&text.replace(names, ""))).unwrap();
        let charts = charts(&tables, None).into_iter();
        let rules = charts.flat_map(|chart| chart.rules);
        let rules = rules.map(|rule| (rule.at, rule.words.into_owned()));
        let rules: Vec<(At, String)> = rules.collect();
        let configurations = table(&tables, "configurations.csv");
        (rules, configurations.numbers("chance").map(<[f64]>::to_vec))
    };
    let (rules, column) = axes(r#"[["mug", "bowl"], ["apple", "pear"]]"#);
    let expected = (At::Value(0.5), "chance (1 in 2)".to_owned());
    assert!(!rules.is_empty());
    assert!(rules.iter().all(|rule| *rule == expected), "{rules:?}");
    assert_eq!(column, None);
    let (rules, column) = axes(r#"[["mug", "bowl"], ["apple", "pear", "mug", "bowl"]]"#);
    let is_column = |(at, _): &(At, String)| *at == At::Column("chance");
    assert!(!rules.is_empty());
    assert!(rules.iter().all(is_column), "{rules:?}");
    assert_eq!(column, Some(vec![0.5, 0.5, 0.25, 0.25]));
}

/// Returns a strength at which a sensor error has a visible effect.
fn strong(strength: &Strength) -> f64 {
    match (strength.is_whole, strength.unit) {
        (true, _) => 5.0,
        (_, "ms") => 20.0,
        _ => 0.2,
    }
}

fn strengths(error: SensorError) -> Vec<f64> {
    error.about().strengths.iter().map(strong).collect()
}

#[test]
fn readings_of_a_touch_differ_if_and_only_if_the_error_is_random_by_reading() {
    let grid = Grid {
        nx: 6,
        ny: 6,
        pitch: 2e-3,
    };
    let taxel = Taxel {
        radius: 1e-3,
        stiffness: 200.0,
        damping: 0.0,
        stroke: 5e-3,
    };
    let patch = Patch::grid(grid, taxel).unwrap();
    for &error in SENSOR_ERRORS {
        let step = error.step(&strengths(error), Seed::new(1)).unwrap();
        let chain = Chain::new(&[step], &patch).unwrap();
        let read = |touch: u64| {
            let mut frames: Vec<f64> = (0..3 * 36).map(|i| 1e-5 * (i * i % 397) as f64).collect();
            let recording = Recording {
                frames: &mut frames,
                rates: None,
                n_before: 0,
                interval: Some(0.04),
                time: None,
            };
            let touch = Seed::new(2018).numbered(touch);
            chain.apply_recording(recording, &touch, &mut SignalWorkspace::default());
            frames
        };
        let differ = read(1) != read(2);
        assert_eq!(differ, error.about().is_random_by_reading, "{error:?}");
    }
}

#[test]
fn more_readings_change_the_training_rows_if_and_only_if_the_error_is_random_by_reading() {
    for &error in SENSOR_ERRORS {
        let about = error.about();
        let key = |strength: &Strength| match strength.is_whole {
            true => format!("{} = 5\n", strength.key),
            false => format!("{} = {:?}\n", strength.key, strong(strength)),
        };
        let keys: String = about.strengths.iter().map(key).collect();
        // The first configuration has no noise; the second one lets all errors have several readings.
        let signal = format!(
            "steps = [\"{}\", \"noise\"]\nnoise_std_full_scale = [0.0, 0.1]\n{}",
            about.step, keys
        );
        let read = |readings: usize| {
            let keys = format!("readings_per_touch = {readings}");
            let text = study(&signal, "ensemble = \"identity\"", &keys);
            let motion = match about.needs_motion {
                true => "frames = 2\nspeed_mm_per_s = 20.0\n",
                false => "frames = 2\n",
            };
            let text = text.replace("depth_mm", &format!("{motion}depth_mm"));
            features(&text, (0, 0))
        };
        let [once, thrice] = [1, 3].map(read);
        let rows = thrice.training(None).unwrap().records;
        let bits = rows.mapv(f64::to_bits);
        let distinct: BTreeSet<Vec<u64>> = bits.outer_iter().map(|row| row.to_vec()).collect();
        match about.is_random_by_reading {
            true => {
                let n_train = thrice.split.train.len();
                assert_eq!(n_train, 3 * once.split.train.len(), "{error:?}");
                assert_eq!(distinct.len(), n_train, "{error:?}");
            }
            false => assert_eq!(thrice.data, once.data, "{error:?}"),
        }
    }
}
