//! How much of the spread of each cell's accuracy comes from splits, from projections, and from the rest.

use super::evaluation::CONFIDENCE;
use super::repeats::{Repeat, scores};
use super::table::{Cell, TrialScore};
use crate::error::Result;
use crate::recognition::statistics::variance::{Component, components};
use crate::row;
use serde::{Deserialize, Serialize};

/// What makes the accuracies of a cell's trials differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// Which touches train and which test.
    Split,
    /// The random projection.
    Projection,
    /// Noise and what else is drawn in each trial, and what a split and a projection do together.
    Rest,
}

row! {
/// What a source adds to the variance of a cell's accuracy: a row of `variance.csv`, for studies with `projections_per_split`.
pub struct Variance {
    /// Number of the cell.
    cell: usize => Subject: Linear;
    /// The source.
    source: Source => Subject "source of variance";
    /// How many of it were drawn; of the rest: trials.
    n_levels: usize => Note "levels": Linear;
    /// Degrees of freedom of its mean square.
    degrees_of_freedom: usize => Note: Linear;
    /// Its mean square.
    mean_square: f64 => Note: Linear;
    /// Unbiased estimate of its variance (method of moments); below zero by chance if it is small.
    estimate: f64 => Note "variance": Linear;
    /// Standard deviation that it alone gives the accuracy: the root of the estimate, 0 if that is below zero.
    accuracy_std: f64 => Value(Less) "standard deviation of the accuracy": Linear between [accuracy_std_low, accuracy_std_high];
    /// Lower end of the 95 % interval of that standard deviation (modified large samples; of the rest χ²).
    accuracy_std_low: f64 => Note "standard deviation, lower end": Linear;
    /// Upper end of the same interval.
    accuracy_std_high: f64 => Note "standard deviation, upper end": Linear;
    /// Share of the variance of a trial, estimates below zero taken as zero; empty if nothing varies.
    share: Option<f64> => Value(Less) "share of the variance": Share;
    /// p-value of the F test that it adds nothing; empty for the rest.
    p_value: Option<f64> => Value(Neither) "p-value": Linear;
} }

/// Three rows a cell whose trials combine every split with every projection; none for other cells.
pub fn variances(rows: &[(Cell, TrialScore)]) -> Result<Vec<Variance>> {
    let mut table = Vec::new();
    for trials in rows.chunk_by(|a, b| a.0.cell == b.0.cell) {
        let trials_of = trials.iter().map(|(_, score)| Repeat::of(score, 1));
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
        let cell = trials[0].0.cell;
        table.extend(parts.map(|(source, part)| row(cell, source, &part, total)));
    }
    Ok(table)
}

fn row(cell: usize, source: Source, part: &Component, total: f64) -> Variance {
    Variance {
        cell,
        source,
        n_levels: part.n_levels,
        degrees_of_freedom: part.degrees_of_freedom,
        mean_square: part.mean_square,
        estimate: part.estimate,
        accuracy_std: part.variance().sqrt(),
        accuracy_std_low: part.interval.low.sqrt(),
        accuracy_std_high: part.interval.high.sqrt(),
        share: (total > 0.0).then(|| part.variance() / total),
        p_value: part.p_value,
    }
}
