//! Summary of trials per configuration: means, intervals, and comparisons with the best configuration.

use crate::error::Result;
use crate::statistics::bootstrap::Bootstrap;
use crate::statistics::grouped::{GroupCount, GroupedTest, interval_of_groups};
use crate::statistics::many_tests::holm_of_some;
use crate::statistics::p_status::CONFIDENCE;
use crate::statistics::repeats::{Paired, Repeat, scores};
use crate::studies::recognition::rows::configuration::Configuration;
use crate::studies::recognition::rows::table_rows::{
    Comparison, ConfigurationScore, Confused, Confusion, Pareto, TrialScore, TrialTime,
};
use crate::studies::recognition::rows::{by_condition, most_accurate};
use crate::table::front;
use bubbletouch_sim::statistics::interval::{Interval, RowTest};
use std::collections::BTreeMap;

/// Row of the table `accuracy.csv`: a configuration, and its score in one trial.
type Row = (Configuration, TrialScore);

/// Returns the rows of each configuration, which are adjacent.
pub(super) fn by_configuration<T>(
    rows: &[(Configuration, T)],
) -> impl Iterator<Item = &[(Configuration, T)]> {
    rows.chunk_by(|a, b| a.0.configuration == b.0.configuration)
}

/// Returns one row per configuration, which summarises its trials. The argument has one row per configuration and trial; the trials of a configuration are
/// adjacent. For each of these rows, `groups` contains the tested groups, if there are any. `n_folds` returns the number of folds of a configuration, or 1
/// without folds.
///
/// # Errors
/// If the trials of a configuration have no rows.
pub fn summarise(
    rows: &[Row],
    mut groups: &[Vec<GroupCount>],
    n_folds: impl Fn(&Configuration) -> usize,
) -> Result<Vec<(Configuration, ConfigurationScore)>> {
    let mut bootstrap = Bootstrap::default();
    let is_grouped = rows.iter().any(|(_, score)| score.n_groups.is_some());
    rows.chunk_by(|a, b| a.0 == b.0)
        .map(|trials| {
            let scores: Vec<&TrialScore> = trials.iter().map(|(_, score)| score).collect();
            let here = groups.split_off(..trials.len()).unwrap_or_default();
            let of_cell = (here, n_folds(&trials[0].0));
            let mut score = score(&scores, of_cell, &mut bootstrap)?;
            // All rows have the same columns; without held-out groups, each test row is a group.
            score.n_groups = score.n_groups.or(is_grouped.then_some(score.n_test));
            Ok((trials[0].0.clone(), score))
        })
        .collect()
}

/// Returns the counts of the trials that hold out whole groups, as input of the statistics over groups.
pub fn grouped_tests<'a>(
    trials: impl Iterator<Item = (&'a TrialScore, &'a Vec<GroupCount>)>,
) -> Vec<GroupedTest<'a>> {
    let tested = trials.filter(|(_, groups)| !groups.is_empty());
    let tested = tested.map(|(trial, groups)| GroupedTest {
        n_rows: trial.n_test,
        n_correct: trial.n_correct,
        groups,
    });
    tested.collect()
}

/// Returns the score of a configuration over all its trials.
fn score(
    trials: &[&TrialScore],
    (groups, n_folds): (&[Vec<GroupCount>], usize),
    bootstrap: &mut Bootstrap,
) -> Result<ConfigurationScore> {
    let mean = |value: fn(&TrialScore) -> f64| {
        trials.iter().map(|trial| value(trial)).sum::<f64>() / trials.len() as f64
    };
    let accuracy = mean(|t| t.accuracy);
    let squares: f64 = trials.iter().map(|t| (t.accuracy - accuracy).powi(2)).sum();
    let n_test = trials.iter().map(|t| t.n_test).min().unwrap_or(0);
    let tested = grouped_tests(trials.iter().copied().zip(groups));
    let (interval, n_groups) = match tested.is_empty() {
        true => {
            let tests = trials.iter().map(|trial| RowTest {
                part: trial.split.unwrap_or(trial.trial) % n_folds,
                n_rows: trial.n_test,
                n_correct: trial.n_correct,
            });
            let tests: Vec<RowTest> = tests.collect();
            (Interval::wilson_of_tests(&tests, CONFIDENCE)?, None)
        }
        false => {
            let (interval, n_groups) = interval_of_groups(&tested, CONFIDENCE)?;
            (interval, Some(n_groups))
        }
    };
    let repeats: Vec<Repeat> = trials.iter().map(|trial| trial.repeat(1)).collect();
    let of_mean = match scores(&repeats) {
        Some(scores) => bootstrap.mean(scores.view(), CONFIDENCE)?,
        None => None,
    };
    Ok(ConfigurationScore {
        n_trials: trials.len(),
        n_test,
        accuracy,
        accuracy_std: match trials.len() {
            1 => 0.0,
            n => (squares / (n - 1) as f64).sqrt(),
        },
        accuracy_low: interval.low,
        accuracy_high: interval.high,
        n_groups,
        bootstrap_low: of_mean.map(|interval| interval.low),
        bootstrap_high: of_mean.map(|interval| interval.high),
        macro_f1: mean(|t| t.macro_f1),
        balanced_accuracy: mean_of_all(trials, |t| t.balanced_accuracy),
        log_loss: trials[0]
            .log_loss
            .map(|_| mean_of_all(trials, |t| t.log_loss.flatten())),
        n_capped: trials.iter().map(|t| t.n_capped).sum(),
    })
}

/// Returns the mean of a value over trials; `None` if a trial does not have it.
fn mean_of_all(trials: &[&TrialScore], value: fn(&TrialScore) -> Option<f64>) -> Option<f64> {
    let sum = trials
        .iter()
        .map(|trial| value(trial))
        .sum::<Option<f64>>()?;
    Some(sum / trials.len() as f64)
}

fn mean(trials: &[Row], value: fn(&TrialScore) -> f64) -> f64 {
    trials.iter().map(|(_, t)| value(t)).sum::<f64>() / trials.len() as f64
}

/// Compares every configuration with the best configuration under the same condition, paired by trial. The best one has the highest mean accuracy (the first in
/// a tie).
///
/// # Errors
/// If a trial has no training or test rows.
pub fn compare_with_best(rows: &[Row]) -> Result<Vec<Comparison>> {
    let configurations: Vec<&[Row]> = by_configuration(rows).collect();
    let mut best = vec![0; configurations.len()];
    for alike in by_condition(configurations.iter().map(|trials| &trials[0].0))? {
        let accuracies = alike
            .iter()
            .map(|&place| (place, mean(configurations[place], |t| t.accuracy)));
        let best_here =
            most_accurate(accuracies).expect("a condition has the configuration that has it");
        alike.iter().for_each(|&place| best[place] = best_here);
    }
    let pairs = configurations.iter().zip(best);
    let rows = pairs.map(|(trials, best)| against(trials, configurations[best]));
    let mut table = rows.collect::<Result<Vec<Comparison>>>()?;
    let is_other = |row: &Comparison| row.configuration != row.best_configuration;
    let p_values = table
        .iter()
        .map(|row| row.p_value.filter(|_| is_other(row)));
    let corrected = holm_of_some(&p_values.collect::<Vec<_>>());
    for (row, p_holm) in table.iter_mut().zip(corrected) {
        row.p_holm = p_holm;
    }
    Ok(table)
}

fn against(trials: &[Row], best: &[Row]) -> Result<Comparison> {
    // Some trials of a configuration may have failed.
    let [ours, theirs] = [trials, best].map(|trials| {
        let scores = trials.iter();
        let scores =
            scores.map(|(configuration, score)| score.repeat(configuration.touches_per_decision));
        scores.collect::<Vec<_>>()
    });
    let paired = Paired::new(&ours, &theirs);
    let (ours, theirs) = match paired.n_trials() {
        0 => (mean(trials, |t| t.accuracy), mean(best, |t| t.accuracy)),
        _ => paired.means(),
    };
    let tested = paired.tested()?;
    let tested = tested.expect("every trial of a table has a size");
    Ok(Comparison {
        configuration: trials[0].0.configuration,
        best_configuration: best[0].0.configuration,
        n_trials: paired.n_trials(),
        difference: ours - theirs,
        difference_low: tested.interval.map(|interval| interval.low),
        difference_high: tested.interval.map(|interval| interval.high),
        p_value: tested.p_value,
        p_holm: None,
        p_status: tested.p_status,
        n_trials_needed: tested.n_needed,
    })
}

/// Maximum number of object pairs in the table of the most frequent confusions.
const MAX_CONFUSED: usize = 15;

/// Returns the pairs of objects that a configuration confuses most often. The pairs are ordered by the fraction of the touched object's test rows; pairs with
/// equal fractions keep the order of the table. `fused` is the number of the configuration with the most touches per decision, and this number of touches.
///
/// # Errors
/// Returns no error for the counts of a table.
pub fn most_confused(
    confusion: &[Confusion],
    configuration: usize,
    fused: Option<(usize, usize)>,
) -> Result<Vec<Confused>> {
    let n_test = rows_of_objects(confusion, configuration);
    let of_fused = fused.map(|(configuration, _)| rows_of_objects(confusion, configuration));
    let fraction_at_max_touches = |of: &Confusion| {
        let ((configuration, _), n_test) = (fused?, of_fused.as_ref()?);
        let mut rows = confusion
            .iter()
            .filter(|row| row.configuration == configuration);
        let same = rows.find(|row| (&row.object, &row.predicted) == (&of.object, &of.predicted));
        let n_test = *n_test.get(of.object.as_str())?;
        Some(same.map_or(0, |row| row.count) as f64 / n_test as f64)
    };
    let pairs = confusion.iter();
    let pairs =
        pairs.filter(|row| row.configuration == configuration && row.object != row.predicted);
    let pairs = pairs.map(|row| {
        let n_test = n_test[row.object.as_str()];
        let interval = Interval::wilson(row.count, n_test, CONFIDENCE)?;
        Ok(Confused {
            configuration,
            object: row.object.clone(),
            predicted: row.predicted.clone(),
            count: row.count,
            n_test,
            fraction: row.count as f64 / n_test as f64,
            fraction_low: interval.low,
            fraction_high: interval.high,
            max_touches_per_decision: fused.map(|(_, n_fused)| n_fused),
            fraction_at_max_touches: fraction_at_max_touches(row),
        })
    });
    let mut pairs = pairs.collect::<Result<Vec<Confused>>>()?;
    pairs.sort_by(|a, b| b.fraction.total_cmp(&a.fraction));
    pairs.truncate(MAX_CONFUSED);
    Ok(pairs)
}

/// Returns the number of test rows of each object in one configuration.
fn rows_of_objects(confusion: &[Confusion], configuration: usize) -> BTreeMap<&str, usize> {
    let mut n_test = BTreeMap::new();
    for row in confusion
        .iter()
        .filter(|row| row.configuration == configuration)
    {
        *n_test.entry(row.object.as_str()).or_default() += row.count;
    }
    n_test
}

/// Returns the accuracy and the costs of every configuration, and marks the Pareto fronts. The two tables have the same rows.
///
/// # Errors
/// If a configuration cannot be written as a row of a table.
pub fn pareto(
    rows: &[Row],
    times: &[(Configuration, TrialTime)],
) -> Result<Vec<(Configuration, Pareto)>> {
    let mut table: Vec<(Configuration, Pareto)> = by_configuration(rows)
        .zip(by_configuration(times))
        .map(|(trials, times)| {
            let n_trials = times.len() as f64;
            let mean_time = |time: fn(&TrialTime) -> f64| {
                times.iter().map(|(_, t)| time(t)).sum::<f64>() / n_trials
            };
            let fit_s = mean_time(|t| t.fit_s);
            let configuration = &trials[0].0;
            let row = Pareto {
                accuracy: mean(trials, |t| t.accuracy),
                fit_s,
                fit_us_per_touch: 1e6 * fit_s / mean(trials, |t| t.n_train as f64),
                predict_us_per_decision: configuration.touches_per_decision as f64
                    * mean_time(|t| t.predict_us_per_touch),
                on_training_front: false,
                on_prediction_front: false,
            };
            (configuration.clone(), row)
        })
        .collect();
    mark_fronts(&mut table)?;
    Ok(table)
}

/// Marks the configurations that no other configuration under the same condition dominates.
fn mark_fronts(table: &mut [(Configuration, Pareto)]) -> Result<()> {
    for alike in by_condition(table.iter().map(|(configuration, _)| configuration))? {
        let on_front = |cost: fn(&Pareto) -> f64| {
            let points = alike.iter().map(|&place| &table[place].1);
            let points = points.map(|row| (cost(row), row.accuracy));
            front(&points.collect::<Vec<_>>(), |a, b| a > b)
        };
        let training = on_front(|row| row.fit_s);
        let prediction = on_front(|row| row.predict_us_per_decision);
        for (place, on) in alike.iter().zip(training.into_iter().zip(prediction)) {
            let row = &mut table[*place].1;
            (row.on_training_front, row.on_prediction_front) = on;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn configuration(
        number: usize,
        noise_std: f64,
        (accuracy, fit_s): (f64, f64),
    ) -> (Configuration, Pareto) {
        let configuration = Configuration {
            configuration: number,
            noise_std,
            ..crate::studies::recognition::rows::configuration::tests::configuration()
        };
        let row = Pareto {
            accuracy,
            fit_s,
            fit_us_per_touch: 0.0,
            predict_us_per_decision: 0.0,
            on_training_front: false,
            on_prediction_front: false,
        };
        (configuration, row)
    }

    #[test]
    fn pairs_are_listed_by_their_share_of_the_objects_test_touches_and_hits_are_not() {
        let row = |configuration, object: &str, predicted: &str, count| Confusion {
            configuration,
            object: object.to_owned(),
            predicted: predicted.to_owned(),
            count,
        };
        let mut table = vec![
            row(0, "mug", "bowl", 9), // another configuration
            row(1, "mug", "mug", 6),
            row(1, "mug", "bowl", 4), // 4 of 10
            row(1, "bowl", "bowl", 1),
            row(1, "bowl", "mug", 3), // 3 of 4: fewer, but a larger share
        ];
        let found = |table: &[Confusion]| -> Vec<(String, usize, usize, f64)> {
            let pairs = most_confused(table, 1, None).unwrap().into_iter();
            pairs
                .map(|p| (p.object, p.count, p.n_test, p.fraction))
                .collect()
        };
        let expected = [
            ("bowl".to_owned(), 3, 4, 0.75),
            ("mug".to_owned(), 4, 10, 0.4),
        ];
        assert_eq!(found(&table), expected);
        // For ten decisions on two touches each, one is wrong for the mug and none for the bowl.
        table.extend([row(2, "mug", "mug", 9), row(2, "mug", "bowl", 1)]);
        table.push(row(2, "bowl", "bowl", 5));
        let fused = most_confused(&table, 1, Some((2, 2))).unwrap();
        let fused = fused
            .into_iter()
            .map(|p| (p.max_touches_per_decision, p.fraction_at_max_touches));
        let expected = [(Some(2), Some(0.0)), (Some(2), Some(0.1))];
        assert_eq!(fused.collect::<Vec<_>>(), expected);
        for other in 0..20 {
            table.push(row(1, "pear", &format!("apple {other}"), 1));
        }
        assert_eq!(found(&table).len(), MAX_CONFUSED);
        assert!(most_confused(&table, 7, None).unwrap().is_empty());
    }

    #[test]
    fn a_cell_is_on_the_front_unless_one_of_the_same_noise_is_no_worse_and_better_in_something() {
        let mut table = [
            configuration(0, 0.0, (0.9, 1.0)),
            configuration(1, 0.0, (0.9, 2.0)), // as accurate, slower than 0
            configuration(2, 0.0, (0.95, 3.0)),
            configuration(3, 0.0, (0.8, 0.5)),
            configuration(4, 0.0, (0.7, 0.5)), // as fast as 3, less accurate
            configuration(5, 0.0, (0.95, 3.0)), // the same as 2
            configuration(6, 0.1, (0.1, 9.0)), // alone with its noise
        ];
        mark_fronts(&mut table).unwrap();
        let on = table.map(|(_, row)| row.on_training_front);
        assert_eq!(on, [true, false, true, true, false, true, true]);
    }
}
