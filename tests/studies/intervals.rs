//! Intervals of accuracies over trials are computed from the counts of the trials.

use crate::study::Study;
use bubbletouch::recognition::statistics::interval::Interval;
use bubbletouch::study::table::{ConfigurationScore, Tables};

const STUDY: &str = include_str!("../fixtures/texts/intervals.toml");

fn run(keys: &str) -> Tables {
    let (head, recognition) = keys.split_once('|').unwrap_or((keys, ""));
    Study::new(&format!("{head}\n{STUDY}{recognition}")).run()
}

/// Returns the summary of each configuration, with the numbers of test rows and of correct rows over all trials.
fn configurations(tables: &Tables) -> Vec<(ConfigurationScore, usize, usize)> {
    let found = tables.summary.iter().map(|(configuration, score)| {
        let trials = tables.accuracy.iter();
        let trials = trials.filter(|(of, _)| of.configuration == configuration.configuration);
        let (n_test, n_correct) = trials.fold((0, 0), |sums, (_, trial)| {
            (sums.0 + trial.n_test, sums.1 + trial.n_correct)
        });
        (score.clone(), n_test, n_correct)
    });
    found.collect()
}

#[test]
fn five_folds_have_the_interval_of_all_rows_that_they_test() {
    let once = run("trials = 5|folds = 5");
    for (score, n_test, n_correct) in configurations(&once) {
        assert_eq!((score.n_test, n_test), (24, 120));
        let all = Interval::wilson(n_correct, n_test, 0.95).unwrap();
        let interval = (score.accuracy_low, score.accuracy_high);
        assert_eq!(interval, (all.low, all.high));
    }
    // The second round of folds tests the same touches again.
    for (score, _, n_correct) in configurations(&run("trials = 10|folds = 5")) {
        let share = n_correct as f64 / 240.0;
        let below = Interval::wilson((120.0 * share).floor() as usize, 120, 0.95).unwrap();
        let above = Interval::wilson((120.0 * share).ceil() as usize, 120, 0.95).unwrap();
        assert!((below.low..=above.low).contains(&score.accuracy_low));
        assert!((below.high..=above.high).contains(&score.accuracy_high));
    }
}

#[test]
fn cells_with_other_counts_over_their_trials_have_other_intervals() {
    let mut found = configurations(&run("trials = 7"));
    found.sort_by_key(|(.., n_correct)| *n_correct);
    assert!(found[0].2 < found[3].2);
    for pair in found.windows(2) {
        let [(less, _, fewer), (more, _, n)] = pair else {
            continue;
        };
        // Rounding to the rows of one trial hides differences of fewer than seven rows.
        assert_eq!(fewer < n, less.accuracy_low < more.accuracy_low);
        assert_eq!(fewer < n, less.accuracy_high < more.accuracy_high);
    }
    for (score, n_test, n_correct) in found {
        assert_eq!((score.n_test, n_test), (30, 210));
        // The Wilson score interval solves (accuracy − p)² = z² p (1 − p) / n, with n of one trial.
        let share = n_correct as f64 / 210.0;
        for p in [score.accuracy_low, score.accuracy_high] {
            let z2 = (share - p).powi(2) * 30.0 / (p * (1.0 - p));
            assert!((z2 - 3.841_458_820_694).abs() < 1e-6, "{p} {z2}");
        }
    }
}
