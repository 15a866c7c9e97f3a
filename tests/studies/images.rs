//! Image features in a study: their effect, their training data, and the inputs that they refuse.

use crate::study::{accuracies, changed, features, run, table};
use bubbletouch::recognition::features::{Cut, FeatureWorkspace, Features, ImageFeatures};
use bubbletouch::studies::recognition::charts::tables_of;
use bubbletouch::world::ImageShape;

const STUDY: &str = include_str!("../fixtures/texts/images.toml");

/// Returns the accuracies of raw measurements and of joined invariant features.
fn two_accuracies(text: &str) -> [f64; 2] {
    let accuracies = accuracies(&run(text)).try_into();
    accuracies.expect("a trial of two configurations")
}

#[test]
fn invariants_recognise_what_is_turned_any_way_and_so_do_estimated_images() {
    let [raw, invariant] = two_accuracies(STUDY);
    assert!(invariant > raw + 0.15, "{raw} {invariant}");
    let sensed = "ensemble = \"principal_components\"\nmeasurements = 48";
    let compressed = STUDY.replace("ensemble = \"identity\"", sensed);
    let [raw, invariant] = two_accuracies(&compressed);
    assert!(invariant > raw + 0.1, "{raw} {invariant}");
}

#[test]
fn features_of_a_whole_frame_are_those_of_the_frame() {
    let [raw, found] = [0, 1].map(|configuration| features(STUDY, (configuration, 0)).data.records);
    let join = Features::try_from("fourier_mellin+polar_harmonics+descriptors".to_owned());
    let join = join.unwrap().of_image().unwrap();
    let features = ImageFeatures::new(join, ImageShape { ny: 24, nx: 24 }, 5e-3, Cut::default());
    let mut out = vec![0.0; join.n_values(ImageShape { ny: 24, nx: 24 })];
    for (frame, row) in raw.outer_iter().zip(found.outer_iter()) {
        let workspace = &mut FeatureWorkspace::default();
        features.write(frame.as_slice().unwrap(), workspace, &mut out);
        assert_eq!(row.to_vec(), out);
    }
}

/// Returns the study with a small skin and few touches, whose images are estimated from eight measurements.
fn estimated(ensemble: &str) -> String {
    let sensed = format!("ensemble = \"{ensemble}\"\nmeasurements = 8");
    let changes = [
        ("ensemble = \"identity\"", &sensed[..]),
        ("per_object = 40", "per_object = 8"),
        ("size_mm = 96.0", "size_mm = 48.0"),
    ];
    changed(STUDY, &changes)
}

/// Tests that image estimators do not depend on test touches.
#[test]
fn what_is_learned_for_images_does_not_know_test_touches() {
    let text = estimated("principal_components").replace("trials = 1", "trials = 2");
    let [set, other] = [0, 1].map(|trial| features(&text, (1, trial)));
    // With another split, the same touches have other features, because other touches were used for fitting.
    assert_ne!(set.split.test, other.split.test);
    assert_ne!(set.data.records.row(0), other.data.records.row(0));
}

#[test]
fn estimators_of_images_are_fitted_to_the_touches_that_train() {
    let text = estimated("gaussian");
    let reduced = |keys: &str| text.replace("classifier =", &format!("{keys}\nclassifier ="));
    let image =
        |keys: &str, configuration| features(&reduced(keys), (configuration, 0)).data.records;
    let (few, many) = ("train_touches = [2, 6]", "train_touches = [6, 2]");
    // Features "raw" come first.
    assert_eq!(image(few, 0), image(few, 1));
    assert_ne!(image(few, 2), image(few, 3));
    assert_eq!(image(few, 2), image(many, 3));
    assert_eq!(image(few, 3), image("train_touches = 6", 1));
    let imbalanced = "class_imbalance = [1.0, 6.0]";
    assert_ne!(image(imbalanced, 2), image(imbalanced, 3));
    // Estimators use no labels.
    let mislabelled = "mislabelled_fraction = [0.0, 0.5]";
    assert_eq!(image(mislabelled, 2), image(mislabelled, 3));
}

#[test]
fn a_depth_changes_no_feature_of_what_is_behind_the_foremost_point() {
    // Returns the fraction of features that are equal at two depths.
    let equal = |keys: &str| {
        let [shallow, deep] = ["2.0", "4.0"].map(|depth| {
            let text = STUDY
                .replace("depth_mm = 3.0", &format!("depth_mm = {depth}"))
                .replace("classifier =", &format!("{keys}\nclassifier ="));
            features(&text, (1, 0)).data.records
        });
        let size = shallow.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        // Frames are stored in f32, so an area may differ by one taxel.
        let is_near = |(a, b): &(&f64, &f64)| (*a - *b).abs() < 1e-3 * size;
        let n_near = shallow.iter().zip(&deep).filter(is_near).count();
        n_near as f64 / shallow.len() as f64
    };
    assert!(equal("depth_window_full_scale = 0.3") > 0.999);
    assert!(equal("") < 0.9);
}

/// Tests that images and invariant features of all layouts give the accuracies of the grid. Slightly curved layouts are equivalent.
#[test]
fn every_layout_has_images_and_their_invariants_recognise_as_those_of_the_grid() {
    let skin = "stroke_mm = 5.0\ncurvature_radius_mm = 2000.0";
    let axes =
        "[axes]\n\"skin.layout\" = [\"grid\", \"hexagonal\", \"disc\", \"cylinder\", \"cap\"]\n";
    let text = STUDY.replace("stroke_mm = 5.0", skin) + axes;
    let tables = run(&text);
    let accuracies = accuracies(&tables);
    let [of_grid, others @ ..] = accuracies.as_chunks::<2>().0 else {
        panic!("a pair a layout");
    };
    assert_eq!(others.len(), 4);
    for [raw, invariant] in others {
        assert!(invariant > raw, "{raw} {invariant}");
        let difference = (invariant - of_grid[1]).abs();
        assert!(difference < 0.1, "{invariant} for {of_grid:?}");
    }
}

#[test]
fn what_has_no_image_stands_in_the_same_tables_as_what_is_behind_the_foremost_point() {
    let windows = "depth_window_full_scale = [0.3, 1.0]\nclassifier =";
    let tables = run(&STUDY.replace("classifier =", windows));
    let summary = tables.summary.iter();
    let seen = summary.map(|(of, _)| of.depth_window_full_scale);
    assert_eq!(seen.collect::<Vec<_>>(), [Some(1.0), Some(0.3), Some(1.0)]);
    table(&tables_of(&tables).unwrap(), "summary.csv");
}

/// Returns a study with listed poses, so that one tilt can be held out.
fn with_copies(keys: &str) -> String {
    let poses = "offset_x_mm = [-4.0, 0.0, 5.0]\nyaw_deg = [0.0, 40.0, 100.0, 200.0, 300.0]\n\
                 tilt_x_deg = [0.0, 5.0]\ntilt_y_deg = [0.0, 5.0]\n";
    let start = STUDY.find("per_object").unwrap();
    let end = STUDY.find("depth_mm").unwrap();
    let text = format!("{}{poses}{}", &STUDY[..start], &STUDY[end..]);
    let text = text.replace("\"raw\", ", "");
    text.replace("classifier =", &format!("{keys}\nclassifier ="))
}

#[test]
fn copies_follow_all_touches_are_as_deep_as_those_that_they_are_of_and_change_no_other() {
    let [none, copied] = [0, 1].map(|configuration| {
        let keys = "split = \"unseen_tilt\"\ntilt_augmentation = [0, 2]\ntrain_touches = 20";
        features(&with_copies(keys), (configuration, 0))
    });
    let (n_touches, n_train) = (none.data.records.nrows(), none.split.train.len());
    assert_eq!((n_touches, n_train), (360, 6 * 20));
    let records = &copied.data.records;
    assert_eq!(records.nrows(), n_touches + 2 * n_train);
    let read = records.slice(ndarray::s![..n_touches, ..]);
    assert_eq!(read, none.data.records);
    assert_eq!(copied.split.test, none.split.test);
    assert_eq!(copied.split.train[..n_train], none.split.train);
    let of_copies = &copied.split.train[n_train..];
    assert!(
        of_copies
            .iter()
            .copied()
            .eq(n_touches..n_touches + 2 * n_train)
    );
    // The largest value is the first of the descriptors.
    let deepest = 216 + 416;
    let mut n_changed = 0;
    for (place, &copy) in of_copies.iter().enumerate() {
        let original = none.split.train[place % n_train];
        assert_eq!(copied.data.targets[copy], none.data.targets[original]);
        let apart = records[[copy, deepest]] - records[[original, deepest]];
        assert!(apart.abs() < 1e-15, "{apart} m");
        n_changed += usize::from(records.row(copy) != records.row(original));
    }
    // A single taxel has no tilt.
    assert!(n_changed > 200, "{n_changed} of 240");
    // Each copy has a different tilt.
    assert_ne!(records.row(n_touches), records.row(n_touches + n_train));
}

#[test]
fn copies_that_are_tilted_recognise_a_tilt_that_was_never_learned() {
    let keys = "split = \"unseen_tilt\"\ntilt_augmentation = [0, 2]";
    let text = with_copies(keys).replace("trials = 1", "trials = 4");
    let tables = run(&text);
    let accuracies = tables.summary.iter().map(|(_, score)| score.accuracy);
    let [none, copied] = accuracies.collect::<Vec<_>>().try_into().unwrap();
    assert!(copied > none + 0.02, "{none} {copied}");
}
