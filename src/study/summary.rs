//! Trials → cells: means, intervals, and every cell against the best one.

use super::evaluation::CONFIDENCE;
use super::table::{Cell, CellScore, Comparison, TrialScore};
use crate::error::Result;
use crate::recognition::comparison::{TrialSize, compare};
use crate::recognition::interval::Interval;

/// A row of the accuracy table.
type Row = (Cell, TrialScore);

/// One row a cell from one row a cell and trial; the trials of a cell follow each other.
pub fn summarise(rows: &[Row]) -> Result<Vec<(Cell, CellScore)>> {
    rows.chunk_by(|a, b| a.0.cell == b.0.cell)
        .map(|trials| Ok((trials[0].0.clone(), score(trials)?)))
        .collect()
}

fn score(trials: &[Row]) -> Result<CellScore> {
    let accuracy = mean(trials, |t| t.accuracy);
    let squares: f64 = trials
        .iter()
        .map(|(_, t)| (t.accuracy - accuracy).powi(2))
        .sum();
    let n_test = trials.iter().map(|(_, t)| t.n_test).min().unwrap_or(0);
    let n_correct = (accuracy * n_test as f64).round() as usize;
    let interval = Interval::wilson(n_correct, n_test, CONFIDENCE)?;
    Ok(CellScore {
        n_trials: trials.len(),
        n_test,
        accuracy,
        accuracy_std: match trials.len() {
            1 => 0.0,
            n => (squares / (n - 1) as f64).sqrt(),
        },
        accuracy_low: interval.low,
        accuracy_high: interval.high,
        macro_f1: mean(trials, |t| t.macro_f1),
        n_capped: trials.iter().map(|(_, t)| t.n_capped).sum(),
    })
}

fn mean(trials: &[Row], value: fn(&TrialScore) -> f64) -> f64 {
    trials.iter().map(|(_, t)| value(t)).sum::<f64>() / trials.len() as f64
}

/// Every cell against the one with the highest mean accuracy (the first of equals), paired trial by trial.
pub fn compare_with_best(rows: &[Row]) -> Result<Vec<Comparison>> {
    let cells: Vec<&[Row]> = rows.chunk_by(|a, b| a.0.cell == b.0.cell).collect();
    let accuracy = |trials: &[Row]| mean(trials, |t| t.accuracy);
    let best = cells.iter().copied().reduce(|best, trials| {
        if accuracy(trials) > accuracy(best) {
            trials
        } else {
            best
        }
    });
    let Some(best) = best else {
        return Ok(Vec::new());
    };
    cells.iter().map(|trials| against(trials, best)).collect()
}

fn against(trials: &[Row], best: &[Row]) -> Result<Comparison> {
    let scores = |rows: &[Row]| -> Vec<f64> { rows.iter().map(|(_, t)| t.accuracy).collect() };
    let (ours, theirs) = (scores(trials), scores(best));
    let size = TrialSize {
        n_train: trials[0].1.n_train,
        n_test: trials[0].1.n_test,
    };
    let test = compare(&ours, &theirs, size, CONFIDENCE)?;
    Ok(Comparison {
        cell: trials[0].0.cell,
        best_cell: best[0].0.cell,
        n_trials: trials.len(),
        difference: mean(trials, |t| t.accuracy) - mean(best, |t| t.accuracy),
        difference_low: test.map(|t| t.interval.low),
        difference_high: test.map(|t| t.interval.high),
        p_value: test.map(|t| t.p_value),
    })
}
