//! Assembly of the result tables from finished configurations, ordered by configuration and trial.

use crate::error::Result;
use crate::learning::evaluation::metrics::ConfusionMatrix;
use crate::studies::recognition::rows::configuration::Configuration;
use crate::studies::recognition::rows::most_accurate;
use crate::studies::recognition::rows::table_rows::{
    ConfigurationScore, Confusion, Recall, SelectedTaxel, Tables, TrialScore,
};
use crate::studies::recognition::spec::study::{ConfusionMatrices, Metric, ReportSpec};
use crate::studies::recognition::tables::summary::{
    compare_with_best, most_confused, pareto, summarise,
};
use crate::studies::recognition::tables::variance_table::variances;
use crate::studies::recognition::training::trial::Evaluation;
use std::collections::BTreeMap;

/// Computes all result tables except the tables of stages and published accuracies.
///
/// # Errors
/// If the trials of a configuration have no rows.
pub fn tabulate(
    tables: &mut Tables,
    mut scored: Vec<(Configuration, Evaluation)>,
    name: impl Fn(&Configuration, usize) -> String,
    place: impl Fn(&Configuration, usize) -> Option<[f64; 2]>,
    n_folds: impl Fn(&Configuration) -> usize,
    report: &ReportSpec,
) -> Result<()> {
    let has = |metric| report.metrics.contains(&metric);
    scored.sort_by_key(|(configuration, evaluation)| {
        (configuration.configuration, evaluation.score.trial)
    });
    share_columns(
        scored
            .iter_mut()
            .map(|(_, found)| &mut found.score)
            .collect(),
    );
    let mut groups = Vec::new();
    let mut confusions = BTreeMap::new();
    for (configuration, mut evaluation) in scored {
        if has(Metric::BalancedAccuracy) {
            let matrix = ConfusionMatrix::of_counts(&evaluation.confusion);
            evaluation.score.balanced_accuracy = Some(matrix.balanced_accuracy());
        }
        evaluation.score.log_loss = has(Metric::LogLoss).then_some(evaluation.log_loss);
        for &(object, predicted, count) in &evaluation.confusion {
            let known = confusions.entry((configuration.configuration, object, predicted));
            let row = known.or_insert_with(|| Confusion {
                configuration: configuration.configuration,
                object: name(&configuration, object),
                predicted: name(&configuration, predicted),
                count: 0,
            });
            row.count += count;
        }
        groups.push(evaluation.groups);
        for (place_in_order, &taxel) in evaluation.selected.iter().enumerate() {
            let xy = place(&configuration, taxel);
            let row = SelectedTaxel {
                rank: place_in_order + 1,
                taxel,
                x_mm: xy.map(|[x, _]| x),
                y_mm: xy.map(|[_, y]| y),
            };
            tables.selected.push((configuration.clone(), row));
        }
        tables
            .accuracy
            .push((configuration.clone(), evaluation.score));
        tables.timing.push((configuration, evaluation.time));
    }
    tables.confusion = confusions.into_values().collect();
    if has(Metric::Recall) {
        tables.recall = recall(&tables.confusion);
    }
    tables.summary = summarise(&tables.accuracy, &groups, n_folds)?;
    tables.variance = variances(&tables.accuracy)?;
    tables.comparison = compare_with_best(&tables.accuracy)?;
    // Confusions of single touches are more informative than confusions of decisions on several touches.
    let summary = || tables.summary.iter();
    let configurations = || summary().map(|(configuration, _)| configuration);
    let accuracy = |(configuration, score): &(Configuration, ConfigurationScore)| {
        (configuration.configuration, score.accuracy)
    };
    let n_touches = configurations().map(|configuration| configuration.touches_per_decision);
    let fewest = n_touches.min().unwrap_or(1);
    let single = summary().filter(|row| row.0.touches_per_decision == fewest);
    if let Some(best) = most_accurate(single.map(accuracy)) {
        let fused = max_touches_per_decision(configurations(), best);
        tables.confused = most_confused(&tables.confusion, best, fused)?;
        if report.confusion == ConfusionMatrices::Best {
            let charted = most_accurate(summary().map(accuracy));
            let kept = [Some(best), fused.map(|(number, _)| number), charted];
            let confusion = &mut tables.confusion;
            confusion.retain(|row| kept.contains(&Some(row.configuration)));
        }
    }
    tables.pareto = pareto(&tables.accuracy, &tables.timing)?;
    Ok(())
}

/// Returns the recall of each object in each configuration. The rows of an object are adjacent.
fn recall(confusion: &[Confusion]) -> Vec<Recall> {
    let is_same =
        |a: &Confusion, b: &Confusion| (a.configuration, &a.object) == (b.configuration, &b.object);
    let of_object = |rows: &[Confusion]| {
        let correct = rows.iter().filter(|row| row.predicted == row.object);
        let n_correct = correct.map(|row| row.count).sum();
        let n_test = rows.iter().map(|row| row.count).sum();
        Recall {
            configuration: rows[0].configuration,
            object: rows[0].object.clone(),
            n_test,
            n_correct,
            recall: n_correct as f64 / n_test as f64,
        }
    };
    confusion.chunk_by(is_same).map(of_object).collect()
}

/// Adds optional columns to all rows if at least one row has them. If a combination of axis values holds out no groups, each test row counts as a group. If a
/// split has no earlier equal split, its first equal split is itself.
pub fn share_columns(mut scores: Vec<&mut TrialScore>) {
    let has_groups = scores.iter().any(|score| score.n_groups.is_some());
    let has_repeats = scores.iter().any(|score| score.distinct_split.is_some());
    for score in &mut scores {
        if has_groups {
            score.n_groups.get_or_insert(score.n_test);
        }
        if has_repeats {
            let split = score.split.unwrap_or(score.trial);
            score.distinct_split.get_or_insert(split);
        }
    }
}

/// Returns the configuration with the most touches per decision among configurations that are otherwise equal, and this number of touches. Returns `None` if no
/// configuration has a larger number than the given one.
fn max_touches_per_decision<'a>(
    mut configurations: impl Iterator<Item = &'a Configuration> + Clone,
    of: usize,
) -> Option<(usize, usize)> {
    let all = configurations.clone();
    let of = configurations.find(|configuration| configuration.configuration == of)?;
    let same = all.filter(|configuration| {
        let alike = Configuration {
            configuration: of.configuration,
            touches_per_decision: of.touches_per_decision,
            ..(*configuration).clone()
        };
        alike == *of && configuration.touches_per_decision > of.touches_per_decision
    });
    let most = same.max_by_key(|configuration| configuration.touches_per_decision)?;
    Some((most.configuration, most.touches_per_decision))
}
