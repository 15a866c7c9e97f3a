//! k-nearest-neighbours classifier: the k training rows with the smallest Euclidean distances vote for their classes.
//!
//! **Ties.** If training rows have equal distances, the row with the lower index is the nearer one. If classes have equal votes, the lower label is predicted.
//! The two rules equal scikit-learn's.
//!
//! Distances are computed by one matrix product per block, `|a|² + |b|² − 2 a·b`, which is inaccurate for close rows. The product therefore only selects
//! candidates: all rows that can be among the k nearest within the rounding error. The distances of the candidates are recomputed by `Σ (a − b)²`, so the
//! result equals an exact pairwise search. Far from the origin there are many candidates; scale the features.

use crate::classifiers::classifier_about::ClassifierAbout;
use crate::classifiers::parameters::{DefaultValue, MAX_COUNT, Parameter};
use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis};
use std::sync::Arc;

use crate::class_model::{ClassModel, log_vote_shares};
use crate::dataset::{Dataset, check_width, checked_classes, positions};
use crate::{Error, Result};

/// Number of rows whose distances to all training rows are computed together. With a larger value, the distances exceed the processor's cache; with a smaller
/// value, the matrix products are inefficient.
const BLOCK_ROWS: usize = 128;

/// Trained k-nearest-neighbours classifier: the training rows and their labels. Scores are the logarithms of smoothed vote fractions.
#[derive(Clone, Debug)]
pub struct KNearest {
    n_neighbours: usize,
    classes: Vec<usize>,
    /// Training rows, n_rows × m.
    rows: Array2<f64>,
    /// Class of each training row, as an index in `classes`.
    label: Vec<usize>,
    squared_norms: Array1<f64>,
}

impl KNearest {
    /// Stores the labelled training rows; the `n_neighbours` nearest rows vote on each prediction.
    ///
    /// # Errors
    /// If `n_neighbours` is not in 1 to the number of rows. If the data are empty, or a feature is NaN, infinite or too large to square. If the number of
    /// labels differs from the number of rows, or there is a single class.
    pub fn train(data: &Dataset, n_neighbours: usize) -> Result<Self> {
        let classes = checked_classes(data)?;
        let n_rows = data.records.nrows();
        if !(1..=n_rows).contains(&n_neighbours) {
            return Err(Error::input(
                "neighbours",
                n_neighbours,
                format!("1 to the {n_rows} training rows is allowed"),
            ));
        }
        let rows = data.records.clone();
        let squared_norms = rows.map_axis(Axis(1), |row| row.dot(&row));
        if let Some(row) = squared_norms.iter().position(|norm| !norm.is_finite()) {
            return Err(Error::input(
                format!("features, row {row}"),
                "values whose squares overflow",
                "scaled features are needed",
            ));
        }
        Ok(Self {
            n_neighbours,
            label: positions(data.targets.view(), &classes),
            classes,
            rows,
            squared_norms,
        })
    }

    /// Returns the indices of the nearest training rows for each row of features, nearest first (n_rows × n_neighbours).
    ///
    /// # Errors
    /// If the number of columns differs from training, or a feature is NaN or infinite.
    pub fn neighbours(&self, features: ArrayView2<f64>) -> Result<Array2<usize>> {
        check_width(&features, self.rows.ncols())?;
        let mut neighbours = Array2::zeros((features.nrows(), self.n_neighbours));
        for (block, mut found) in features
            .axis_chunks_iter(Axis(0), BLOCK_ROWS)
            .zip(neighbours.axis_chunks_iter_mut(Axis(0), BLOCK_ROWS))
        {
            let products = block.dot(&self.rows.t());
            for ((row, products), mut found) in block
                .rows()
                .into_iter()
                .zip(products.rows())
                .zip(found.rows_mut())
            {
                let nearest = self.nearest(row, products);
                found
                    .iter_mut()
                    .zip(nearest)
                    .for_each(|(to, row)| *to = row);
            }
        }
        Ok(neighbours)
    }

    /// Returns the indices of the nearest training rows of one row, given its inner products with all training rows.
    fn nearest(&self, row: ArrayView1<f64>, products: ArrayView1<f64>) -> Vec<usize> {
        let norm = row.dot(&row);
        let rough = |other: usize| norm + self.squared_norms[other] - 2.0 * products[other];
        // The k smallest approximate distances, ascending; the last one is the threshold.
        let k = self.n_neighbours;
        let mut smallest = vec![f64::INFINITY; k];
        for other in 0..products.len() {
            let distance = rough(other);
            if distance < smallest[k - 1] {
                let place = smallest.partition_point(|&nearer| nearer <= distance);
                smallest.copy_within(place..k - 1, place + 1);
                smallest[place] = distance;
            }
        }
        // The neighbours' squared norms are at most 2|a|² + 2|a − b|². The error of a product of m terms is below m roundings.
        let bar = smallest[k - 1];
        let rounding = 4.0 * (row.len() + 8) as f64 * f64::EPSILON;
        let is_out = |other: &usize| {
            let reach = 4.0 * norm + 2.0 * bar.max(0.0) + self.squared_norms[*other];
            rough(*other) - bar > rounding * reach
        };
        let mut nominees: Vec<(f64, usize)> = (0..products.len())
            .filter(|other| !is_out(other))
            .map(|other| (squared_distance(row, self.rows.row(other)), other))
            .collect();
        nominees.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        nominees.truncate(k);
        nominees.into_iter().map(|(_, other)| other).collect()
    }
}

impl ClassModel for KNearest {
    fn classes(&self) -> &[usize] {
        &self.classes
    }

    fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        let neighbours = self.neighbours(features)?;
        let mut votes = Array2::zeros((features.nrows(), self.classes.len()));
        for (mut votes, neighbours) in votes.rows_mut().into_iter().zip(neighbours.rows()) {
            for &row in neighbours {
                votes[self.label[row]] += 1.0;
            }
        }
        Ok(log_vote_shares(votes))
    }
}

fn squared_distance(a: ArrayView1<f64>, b: ArrayView1<f64>) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

const N_NEIGHBOURS: Parameter = Parameter::integer(
    "n_neighbours",
    "number k of nearest neighbours",
    [1.0, MAX_COUNT],
    DefaultValue::Number(5.0),
);

pub(crate) const ABOUT: ClassifierAbout = ClassifierAbout {
    parameters: &[N_NEIGHBOURS],
    ..ClassifierAbout::new("k nearest neighbours", |classifier, scaled, _, _| {
        let n_neighbours = N_NEIGHBOURS.count(&classifier.parameters);
        Ok(Arc::new(KNearest::train(scaled, n_neighbours)?))
    })
};
