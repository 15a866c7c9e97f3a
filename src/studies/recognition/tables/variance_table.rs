//! Analysis of variance of each configuration's accuracy, with the sources splits, projections and rest.

use crate::error::Result;
use crate::statistics::p_status::CONFIDENCE;
use crate::statistics::repeats::scores;
use crate::statistics::variance::{Component, components};
use crate::studies::recognition::rows::configuration::Configuration;
use crate::studies::recognition::rows::table_rows::{Source, TrialScore, Variance};
use crate::studies::recognition::tables::summary::by_configuration;

/// Returns the rows of `variance.csv`: three for each configuration whose trials combine every split with every projection. Configurations without all
/// combinations have no rows.
///
/// # Errors
/// If the scores of a configuration cannot be decomposed.
pub fn variances(rows: &[(Configuration, TrialScore)]) -> Result<Vec<Variance>> {
    let mut table = Vec::new();
    for trials in by_configuration(rows) {
        let trials_of = trials.iter().map(|(_, score)| score.repeat(1));
        let scores = scores(&trials_of.collect::<Vec<_>>());
        let Some(scores) = scores.filter(|scores| scores.ncols() > 1 && scores.nrows() > 1) else {
            continue;
        };
        let found = components(scores.view(), CONFIDENCE)?;
        let parts = [
            (Source::Split, found.rows),
            (Source::Projection, found.columns),
            (Source::Rest, found.rest),
        ];
        let total: f64 = parts.iter().map(|(_, part)| part.variance()).sum();
        let configuration = trials[0].0.configuration;
        table.extend(parts.map(|(source, part)| row(configuration, source, &part, total)));
    }
    Ok(table)
}

fn row(configuration: usize, source: Source, part: &Component, total: f64) -> Variance {
    Variance {
        configuration,
        source,
        n_levels: part.n_levels,
        degrees_of_freedom: part.degrees_of_freedom,
        mean_square: part.mean_square,
        estimate: part.estimate,
        accuracy_std: part.variance().sqrt(),
        accuracy_std_low: part.interval.low.sqrt(),
        accuracy_std_high: part.interval.high.sqrt(),
        fraction: (total > 0.0).then(|| part.variance() / total),
        p_value: part.p_value,
    }
}
