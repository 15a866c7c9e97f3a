//! Two-way analysis of variance.

use crate::{Error, Result};
use ndarray::{ArrayView2, Axis};

/// Mean squares of a two-way analysis of variance with one score per entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MeanSquares {
    pub mean: f64,
    pub rows: f64,
    pub columns: f64,
    pub rest: f64,
    n_rows: usize,
    n_columns: usize,
}

impl MeanSquares {
    pub fn new(scores: ArrayView2<f64>) -> Result<Self> {
        let (n_rows, n_columns) = scores.dim();
        if n_rows < 2 || n_columns < 2 {
            let given = format!("{n_rows} × {n_columns} scores");
            return Err(Error::input("variance components", given, "at least 2 × 2"));
        }
        if let Some(score) = scores.iter().find(|score| !score.is_finite()) {
            return Err(Error::input("variance components", score, "finite scores"));
        }
        let mean = scores.sum() / scores.len() as f64;
        let means = |axis: usize| {
            let n = scores.len_of(Axis(axis)) as f64;
            scores.sum_axis(Axis(axis)) / n
        };
        let (of_rows, of_columns) = (means(1), means(0));
        let squares = |means: &ndarray::Array1<f64>| -> f64 {
            means.iter().map(|m| (m - mean).powi(2)).sum()
        };
        let rest: f64 = scores
            .indexed_iter()
            .map(|((r, c), y)| (y - of_rows[r] - of_columns[c] + mean).powi(2))
            .sum();
        let freedom = (n_rows - 1) * (n_columns - 1);
        Ok(Self {
            mean,
            rows: n_columns as f64 * squares(&of_rows) / (n_rows - 1) as f64,
            columns: n_rows as f64 * squares(&of_columns) / (n_columns - 1) as f64,
            rest: rest / freedom as f64,
            n_rows,
            n_columns,
        })
    }

    pub fn rest_freedom(&self) -> usize {
        (self.n_rows - 1) * (self.n_columns - 1)
    }
}
