//! Variance of the accuracy due to splits, separated from the variance due to projections.

use crate::study::Study;
use bubbletouch::report::folder::{table_files, write_files};
use bubbletouch::studies::recognition::charts::{read_tables, tables_of};
use bubbletouch::study::table::{Configuration, PStatus, Source, Tables, TrialScore, Variance};
use std::path::Path;

/// Returns a study of three objects that are hard to distinguish, with few measurements.
fn text(repeats: &str, ensemble: &str, noise: f64) -> String {
    format!(
        r#"
question = "Which chance is it?"
{repeats}

[objects]
sets = ["household"]
names = ["mug", "apple", "orange", "pear"]
surface_error_mm = 1.0

[skin]
pitch_mm = 4.0
size_mm = 64.0
stroke_mm = 5.0

[touches]
per_object = 16
offset_x_mm = {{ uniform = [-12.0, 12.0] }}
offset_y_mm = {{ uniform = [-12.0, 12.0] }}
depth_mm = 3.0

[signal]
steps = ["noise"]
noise_std_full_scale = {noise:?}

[sensing]
ensemble = {ensemble}
measurements = 8

[recognition]
classifier = "linear_svm"
"#
    )
}

fn row(outcome: &Tables, configuration: usize, source: Source) -> &Variance {
    let mut rows = outcome.variance.iter();
    rows.find(|row| row.configuration == configuration && row.source == source)
        .unwrap()
}

fn trials(outcome: &Tables, configuration: usize) -> Vec<&TrialScore> {
    let rows = outcome.accuracy.iter();
    let of_cell =
        rows.filter(|(row, _): &&(Configuration, TrialScore)| row.configuration == configuration);
    of_cell.map(|(_, score)| score).collect()
}

#[test]
fn without_noise_all_that_varies_is_the_split_unless_a_projection_is_drawn() {
    let crossed = "trials = 20\nprojections_per_split = 4";
    let study = Study::new(&text(crossed, r#"["identity", "gaussian"]"#, 0.0));
    let outcome = study.run();
    assert_eq!(outcome.variance.len(), 6);
    for (source, n_levels) in [
        (Source::Split, 5),
        (Source::Projection, 4),
        (Source::Rest, 20),
    ] {
        assert_eq!(row(&outcome, 0, source).n_levels, n_levels);
    }
    // Every taxel is measured, so the four projections are equivalent.
    let (split, rest) = (
        row(&outcome, 0, Source::Split),
        row(&outcome, 0, Source::Rest),
    );
    assert!(
        split.accuracy_std > 0.0 && split.fraction.unwrap() > 1.0 - 1e-9,
        "{split:?}"
    );
    assert!(rest.accuracy_std < 1e-9, "{rest:?}");
    assert!(row(&outcome, 0, Source::Projection).accuracy_std < 1e-9);
    // With eight random measurements, their choice matters.
    let shares: f64 = [Source::Split, Source::Projection, Source::Rest]
        .map(|source| row(&outcome, 1, source).fraction.unwrap())
        .iter()
        .sum();
    assert!((shares - 1.0).abs() < 1e-12);
    let of_gaussian = row(&outcome, 1, Source::Projection);
    let rest = row(&outcome, 1, Source::Rest);
    assert!(
        of_gaussian.accuracy_std + rest.accuracy_std > 0.01,
        "{of_gaussian:?}"
    );
}

#[test]
fn crossed_trials_share_splits_and_projections_and_the_first_is_that_of_trials_of_their_own() {
    let ensemble = r#"["gaussian", "sbhe"]"#;
    let crossed = Study::new(&text(
        "trials = 6\nprojections_per_split = 3",
        ensemble,
        0.05,
    ));
    let own = Study::new(&text("trials = 2", ensemble, 0.05));
    for trial in 0..6 {
        assert_eq!(crossed.sweep.splits[trial], own.sweep.splits[trial / 3]);
    }
    let (crossed, own) = (crossed.run(), own.run());
    let numbers = |trial: &TrialScore| (trial.split.unwrap(), trial.projection.unwrap());
    for configuration in 0..2 {
        let (trials, own) = (trials(&crossed, configuration), trials(&own, configuration));
        let met: Vec<_> = trials.iter().map(|trial| numbers(trial)).collect();
        assert_eq!(met, [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)]);
        assert_eq!((own[0].split, own[0].projection), (None, None));
        assert_eq!(
            trials[0].n_correct, own[0].n_correct,
            "split, projection and noise 0"
        );
    }
    // Two splits and three projections are few: there is an interval, but no p-value below four splits.
    let compared = crossed.comparison.iter();
    let compared: Vec<_> = compared
        .filter(|row| row.configuration != row.best_configuration)
        .collect();
    assert_eq!(compared.len(), 1);
    assert!(compared[0].difference_low.is_some() && compared[0].p_value.is_none());
    assert_eq!(compared[0].p_status, PStatus::TooFewTrials);
    assert_eq!(compared[0].n_trials_needed, Some(12));
    assert!(own.variance.is_empty());
}

#[test]
fn the_table_is_written_only_where_it_has_rows_and_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let study = |repeats| Study::new(&text(repeats, r#""gaussian""#, 0.02)).run();
    let crossed = study("trials = 25\nprojections_per_split = 5");
    assert!(crossed.summary[0].1.bootstrap_low.unwrap() < crossed.summary[0].1.accuracy);
    let written = |folder: &Path, tables| {
        let made = tables_of(tables).unwrap();
        write_files(folder, table_files(&made)).unwrap();
        let read = read_tables(folder).unwrap();
        assert_eq!(read.len(), made.len());
        assert!(read.iter().zip(&made).all(|(a, b)| a.csv == b.csv));
    };
    written(folder.path(), &crossed);
    let other = tempfile::tempdir().unwrap();
    let own = study("trials = 4");
    assert_eq!(
        own.summary[0].1.bootstrap_low, None,
        "four trials are too few"
    );
    written(other.path(), &own);
    assert!(folder.path().join("variance.csv").exists());
    assert!(!other.path().join("variance.csv").exists());
    let header = std::fs::read_to_string(other.path().join("accuracy.csv")).unwrap();
    assert!(
        !header.lines().next().unwrap().contains("split"),
        "{header}"
    );
}
