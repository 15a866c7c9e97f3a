//! k-nearest-neighbours classifier: the k training rows with the smallest Euclidean distances vote for their classes.
//!
//! **Ties.** If training rows have equal distances, the row with the lower index is the nearer one. If classes have equal votes, the lower label is predicted.
//! The two rules equal scikit-learn's.
//!
//! Distances are computed in f32 as `|a|² + |b|² − 2 a·b`, by one matrix product per block. The mean of the training rows is subtracted from the rows, and
//! the result is divided by the largest value. The product only selects candidates: all rows that can be among the k nearest within the rounding error. The
//! distances of the candidates are recomputed in f64 by `Σ (a − b)²`, so the result equals an exact pairwise search. If a few rows are much larger than the
//! others, there are many candidates; scale the features.
//!
//! **Rounding.** Let u = 2⁻²⁴. Converting two rows to f32 changes their squared distance by at most 4u (|a|² + |b|²). The m products and their sum add at
//! most (m + 6) u (|a|² + |b|²). The k rows with the smallest computed distances, at most r, have |b|² ≤ 2|a|² + 2r. Another row c can be nearer than one
//! of them only if its computed distance is at most r + (m + 16) u (4|a|² + 2r + |c|²). The code uses twice this bound.

use crate::classifiers::classifier_about::ClassifierAbout;
use crate::classifiers::parameters::{DefaultValue, MAX_COUNT, Parameter};
use ndarray::{Array1, Array2, ArrayView1, ArrayView2, ArrayViewMut1, Axis};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

use crate::class_model::{ClassModel, log_vote_shares};
use crate::dataset::{Dataset, check_width, checked_classes, positions, squared_norms};
use crate::linalg::products::multiply;
use crate::saved::SavedModel;
use crate::{Error, Result};

/// Number of rows whose distances to all training rows are computed together. With a larger value, the distances need more memory, 2 KiB per training row
/// here. With a smaller value, each matrix product spends more time on copying the training rows into panels. With 128 rows of 256 features, copying takes
/// 36 % of the time.
const BLOCK_ROWS: usize = 512;

/// Trained k-nearest-neighbours classifier: the training rows and their labels. Scores are the logarithms of smoothed vote fractions.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(from = "SavedNeighbours")]
pub struct KNearest {
    n_neighbours: usize,
    classes: Vec<usize>,
    /// Training rows, n_rows × m.
    #[serde(with = "crate::saved")]
    rows: Array2<f64>,
    /// Class of each training row, as an index in `classes`.
    label: Vec<usize>,
    #[serde(skip)]
    screen: Screen,
}

/// Fields of [`KNearest`] from which the others are computed.
#[derive(Deserialize)]
struct SavedNeighbours {
    n_neighbours: usize,
    classes: Vec<usize>,
    #[serde(with = "crate::saved")]
    rows: Array2<f64>,
    label: Vec<usize>,
}

impl From<SavedNeighbours> for KNearest {
    fn from(saved: SavedNeighbours) -> Self {
        Self {
            n_neighbours: saved.n_neighbours,
            classes: saved.classes,
            screen: Screen::new(saved.rows.view()),
            rows: saved.rows,
            label: saved.label,
        }
    }
}

/// Training rows in f32, moved and scaled, for the selection of candidates.
#[derive(Clone, Debug)]
struct Screen {
    mean: Array1<f64>,
    /// Factor by which moved rows are multiplied, so that the largest absolute training value is 1.
    scale: f64,
    /// Moved and scaled training rows, n_rows × m.
    rows: Array2<f32>,
    squared_norms: Vec<f32>,
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
        squared_norms(rows.view())?;
        Ok(Self {
            n_neighbours,
            label: positions(data.targets.view(), &classes),
            classes,
            screen: Screen::new(rows.view()),
            rows,
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
            let screened = self.screen.converted(block);
            let mut products = Array2::zeros((block.nrows(), self.rows.nrows()));
            multiply(
                screened.view(),
                self.screen.rows.view(),
                products.view_mut(),
            );
            let rows = block.rows().into_iter().zip(screened.rows());
            for ((row, products), mut found) in rows.zip(products.rows_mut()).zip(found.rows_mut())
            {
                let nearest = self.nearest(row, products);
                let places = found.iter_mut().zip(nearest);
                places.for_each(|(to, row)| *to = row);
            }
        }
        Ok(neighbours)
    }

    /// Returns the indices of the nearest training rows of one row. The arguments are the row in f64, the screened row in f32, and the inner products of
    /// the screened row with all screened training rows. The products are overwritten.
    fn nearest(
        &self,
        (row, screened): (ArrayView1<f64>, ArrayView1<f32>),
        mut products: ArrayViewMut1<f32>,
    ) -> Vec<usize> {
        let norm: f32 = screened.iter().map(|value| value * value).sum();
        let distances = products.as_slice_mut().expect("rows are whole");
        let norms = &self.screen.squared_norms[..];
        for (distance, other) in distances.iter_mut().zip(norms) {
            *distance = (norm + other) - 2.0 * *distance;
        }
        let kth = kth_smallest(distances, self.n_neighbours);
        let rounding = (row.len() + 16) as f32 * f32::EPSILON;
        let reach = kth + rounding * (4.0 * norm + 2.0 * kth.max(0.0)) + UNDERFLOW;
        let mut candidates = Vec::new();
        // A row too large for f32 has no finite distances; it is compared with all training rows.
        match reach.is_finite() {
            true => within(distances, (norms, rounding), reach, &mut candidates),
            false => candidates.extend(0..distances.len()),
        }
        let exact = |other: usize| (squared_distance(row, self.rows.row(other)), other);
        let mut nominees: Vec<(f64, usize)> = candidates.into_iter().map(exact).collect();
        nominees.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        nominees.truncate(self.n_neighbours);
        nominees.into_iter().map(|(_, other)| other).collect()
    }
}

/// Error of a distance due to products below the smallest normal f32, for 2²⁰ features whose largest value is 1.
const UNDERFLOW: f32 = 1e-30;

impl Screen {
    fn new(rows: ArrayView2<f64>) -> Self {
        let mean = rows.mean_axis(Axis(0)).expect("at least one row");
        let moved = &rows - &mean;
        let largest = moved.fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let mut screen = Self {
            mean,
            scale: Some(1.0 / largest)
                .filter(|scale| scale.is_finite())
                .unwrap_or(1.0),
            rows: Array2::zeros((0, rows.ncols())),
            squared_norms: Vec::new(),
        };
        screen.rows = screen.converted(rows);
        let norm = |row: ArrayView1<f32>| row.iter().map(|&v| f64::from(v).powi(2)).sum::<f64>();
        let norms = screen.rows.outer_iter().map(|row| norm(row) as f32);
        screen.squared_norms = norms.collect();
        screen
    }

    /// Returns rows moved to the mean of the training rows, scaled, and rounded to f32.
    fn converted(&self, rows: ArrayView2<f64>) -> Array2<f32> {
        let moved = &rows - &self.mean;
        moved.mapv(|value| (value * self.scale) as f32)
    }
}

/// Number of distances that are compared together.
const LANES: usize = 16;

/// Returns the k-th smallest distance, 1 ≤ k ≤ the number of distances; infinity if fewer than k distances are numbers.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn kth_smallest(distances: &[f32], k: usize) -> f32 {
    let mut smallest = vec![f32::INFINITY; k];
    for chunk in distances.chunks(LANES) {
        let mut is_any = false;
        for distance in chunk {
            is_any |= *distance < smallest[k - 1];
        }
        if !is_any {
            continue;
        }
        for &distance in chunk {
            if distance < smallest[k - 1] {
                let place = smallest.partition_point(|&nearer| nearer <= distance);
                smallest.copy_within(place..k - 1, place + 1);
                smallest[place] = distance;
            }
        }
    }
    smallest[k - 1]
}

/// Collects the indices of the rows whose distance, less the rounding of their squared norm, is within `reach`.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn within(
    distances: &[f32],
    (norms, rounding): (&[f32], f32),
    reach: f32,
    candidates: &mut Vec<usize>,
) {
    let chunks = distances.chunks(LANES).zip(norms.chunks(LANES));
    for (number, (distances, norms)) in chunks.enumerate() {
        let mut is_any = false;
        for (distance, norm) in distances.iter().zip(norms) {
            is_any |= distance - rounding * norm <= reach;
        }
        if is_any {
            let both = distances.iter().zip(norms).enumerate();
            let near = both.filter(|(_, (distance, norm))| *distance - rounding * *norm <= reach);
            candidates.extend(near.map(|(place, _)| number * LANES + place));
        }
    }
}

impl ClassModel for KNearest {
    fn saved(&self) -> Option<SavedModel> {
        Some(SavedModel::KNearest(self.clone()))
    }

    fn classes(&self) -> &[usize] {
        &self.classes
    }

    fn is_probabilistic(&self) -> bool {
        true
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
)
.at_most_rows();

pub(crate) const ABOUT: ClassifierAbout = ClassifierAbout {
    parameters: &[N_NEIGHBOURS],
    ..ClassifierAbout::new("k nearest neighbours", |classifier, scaled, _, _| {
        let n_neighbours = N_NEIGHBOURS.count(&classifier.parameters);
        Ok(Arc::new(KNearest::train(scaled, n_neighbours)?))
    })
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::dataset;

    /// Returns the nearest training rows by definition: one distance at a time, ties to the lower index.
    fn by_pairs(training: ArrayView2<f64>, row: ArrayView1<f64>, k: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..training.nrows()).collect();
        let distance = |other: &usize| squared_distance(row, training.row(*other));
        order.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        order.truncate(k);
        order
    }

    #[test]
    fn candidates_contain_the_nearest_rows_whatever_the_size_of_the_values() {
        let wave = |i: usize, j: usize, shift: f64| ((i * 37 + j * 11) as f64 * 0.83 + shift).sin();
        let like = |i: usize, j: usize| match i % 7 {
            // Rows that differ from earlier ones by less than the resolution of f32.
            0 => wave(i / 14, j, 0.0) + 1e-9 * i as f64,
            _ => wave(i, j, 0.0),
        };
        for (scale, offset, outlier) in [
            (1.0, 0.0, None),
            (1.0, 1e6, None),
            (1e-120, 0.0, None),
            (1e100, 0.0, None),
            (1.0, 0.0, Some(1e30)),
            (1e-30, 0.0, Some(1.0)),
        ] {
            let value = |i: usize, j: usize, shift: f64| offset + scale * (like(i, j) + shift);
            let mut rows = Array2::from_shape_fn((150, 9), |(i, j)| value(i, j, 0.0));
            if let Some(outlier) = outlier {
                rows[[77, 3]] = outlier;
            }
            let labels = (0..150).map(|i| i % 3).collect();
            let model = KNearest::train(&dataset(rows.clone(), labels).unwrap(), 4).unwrap();
            let mut asked = Array2::from_shape_fn((40, 9), |(i, j)| value(i, j, 0.01 * i as f64));
            asked.row_mut(5).fill(1e25 * scale);
            let found = model.neighbours(asked.view()).unwrap();
            for (row, found) in asked.rows().into_iter().zip(found.rows()) {
                assert_eq!(
                    found.to_vec(),
                    by_pairs(rows.view(), row, 4),
                    "{scale} {offset}"
                );
            }
        }
    }

    #[test]
    fn few_rows_are_candidates_for_many_training_rows() {
        let rows = Array2::from_shape_fn((3000, 64), |(i, j)| {
            ((i * 131 + j * 71) as f64 * 0.417).sin() + ((i * 17 + j * j * 3) as f64).cos()
        });
        let labels = (0..3000).map(|i| i % 5).collect();
        let model = KNearest::train(&dataset(rows.clone(), labels).unwrap(), 5).unwrap();
        let screened = model.screen.converted(rows.slice(ndarray::s![..20, ..]));
        for (row, screened) in screened.rows().into_iter().enumerate() {
            let norm: f32 = screened.iter().map(|value| value * value).sum();
            let products = model.screen.rows.dot(&screened);
            let norms = &model.screen.squared_norms[..];
            let distances: Vec<f32> = products
                .iter()
                .zip(norms)
                .map(|(product, other)| (norm + other) - 2.0 * product)
                .collect();
            let kth = kth_smallest(&distances, 5);
            let mut sorted = distances.clone();
            sorted.sort_by(f32::total_cmp);
            assert_eq!(kth, sorted[4]);
            let mut candidates = Vec::new();
            let rounding = 80.0 * f32::EPSILON;
            let reach = kth + rounding * (4.0 * norm + 2.0 * kth);
            within(&distances, (norms, rounding), reach, &mut candidates);
            assert!(
                candidates.contains(&row) && candidates.len() < 20,
                "{}",
                candidates.len()
            );
        }
    }
}
