//! Variance of the accuracy due to splits, separated from the variance due to projections.

use crate::study::{Study, assert_reads_back, changed, laid_out};
use bubbletouch::studies::recognition::charts::tables_of;
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::{Comparison, PStatus, Source, Tables, TrialScore, Variance};

/// Returns a study of four objects that are hard to distinguish, with few measurements.
fn text(repeats: &str, ensemble: &str, noise: f64) -> String {
    let changes = [
        ("trials = 18\nprojections_per_split = 3", repeats),
        ("full_scale = 0.0", &format!("full_scale = {noise:?}")),
        ("ensemble = \"gaussian\"", &format!("ensemble = {ensemble}")),
        ("folds = 3", ""),
    ];
    changed(include_str!("../fixtures/texts/variance.toml"), &changes)
}

fn row(outcome: &Tables, configuration: usize, source: Source) -> &Variance {
    let mut rows = outcome.variance.iter();
    let row = rows.find(|row| row.configuration == configuration && row.source == source);
    row.unwrap()
}

fn trials(outcome: &Tables, configuration: usize) -> Vec<&TrialScore> {
    let rows = outcome.accuracy.iter();
    let own = rows.filter(|(row, _)| row.configuration == configuration);
    own.map(|(_, score)| score).collect()
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
    let split = row(&outcome, 0, Source::Split);
    assert!(split.accuracy_std > 0.0, "{split:?}");
    assert!(split.fraction.unwrap() > 1.0 - 1e-9, "{split:?}");
    for source in [Source::Rest, Source::Projection] {
        assert!(row(&outcome, 0, source).accuracy_std < 1e-9, "{source:?}");
    }
    // With eight random measurements, their choice matters.
    let [split, projection, rest] =
        [Source::Split, Source::Projection, Source::Rest].map(|source| row(&outcome, 1, source));
    let shares = [split, projection, rest].map(|row| row.fraction.unwrap());
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    let std = projection.accuracy_std + rest.accuracy_std;
    assert!(std > 0.01, "{projection:?}");
}

#[test]
fn crossed_trials_share_splits_and_projections_and_the_first_is_that_of_trials_of_their_own() {
    let ensemble = r#"["gaussian", "sbhe"]"#;
    let crossed = "trials = 6\nprojections_per_split = 3";
    let crossed = Study::new(&text(crossed, ensemble, 0.05));
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
        // Split, projection and noise 0.
        assert_eq!(trials[0].n_correct, own[0].n_correct);
    }
    // Two splits and three projections are few: there is an interval, but no p-value below four splits.
    let is_other = |row: &&Comparison| row.configuration != row.best_configuration;
    let compared: Vec<_> = crossed.comparison.iter().filter(is_other).collect();
    let [other] = compared[..] else {
        panic!("one comparison: {compared:?}");
    };
    assert!(other.difference_low.is_some() && other.p_value.is_none());
    assert_eq!(other.p_status, PStatus::TooFewTrials);
    assert_eq!(other.n_trials_needed, Some(12));
    assert!(own.variance.is_empty());
}

#[test]
fn the_table_is_written_only_where_it_has_rows_and_is_read_again() {
    let study = |repeats| {
        let study = laid_out(&text(repeats, r#""gaussian""#, 0.02)).unwrap();
        let outcome = study.run(&Silent).unwrap();
        let made = tables_of(&outcome).unwrap();
        assert_reads_back(&study, &made);
        let has_rows = made
            .iter()
            .any(|table| table.file == "variance.csv" && !table.csv.is_empty());
        let has_column = made[0].column("split").is_some();
        (outcome.summary[0].1.clone(), has_rows, has_column)
    };
    let (crossed, has_rows, has_column) = study("trials = 25\nprojections_per_split = 5");
    assert!(crossed.bootstrap_low.unwrap() < crossed.accuracy);
    assert!(has_rows && has_column);
    let (own, has_rows, has_column) = study("trials = 4");
    // Four trials are too few.
    assert_eq!(own.bootstrap_low, None);
    assert!(!has_rows && !has_column);
}
