//! Nearest rows by Euclidean distance, by blocks of matrix products.

use ndarray::{ArrayView1, ArrayView2, Axis, s};
use std::ops::Range;

/// Nearest rows of a block of rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NearestRows {
    /// Indices of the k nearest other rows of each row of the block, nearest first; fewer if there are fewer rows.
    pub neighbours: Vec<Vec<usize>>,
    /// Distances to `neighbours`, computed from the differences of the two rows.
    pub distances: Vec<Vec<f64>>,
    /// Nearest row in another fold, for each assignment of folds and each row of the block. `None` if the row is in no fold or all rows are in one fold.
    pub outside: Vec<Vec<Option<usize>>>,
}

/// Returns the `k` nearest other rows of the rows in `block`. Also returns the nearest row in another fold for each of the assignments `folds`. An
/// assignment contains one fold number per row, or `None` for a row that is neither trained on nor tested.
///
/// If distances are equal, the smaller index is returned. Distances are compared in the form |a|² + |b|² − 2 a·b.
pub fn nearest_rows(
    features: ArrayView2<f64>,
    k: usize,
    folds: &[Vec<Option<usize>>],
    block: Range<usize>,
) -> NearestRows {
    let n = features.nrows();
    let k = k.min(n.saturating_sub(1));
    let squares: Vec<f64> = features.rows().into_iter().map(|r| r.dot(&r)).collect();
    let products = features.slice(s![block.clone(), ..]).dot(&features.t());
    // Numbers instead of options keep the inner loop short; the number `usize::MAX` represents "no fold".
    let folds: Vec<Vec<usize>> = folds
        .iter()
        .map(|folds| {
            folds
                .iter()
                .map(|fold| fold.unwrap_or(usize::MAX))
                .collect()
        })
        .collect();
    let mut found = NearestRows {
        neighbours: Vec::with_capacity(block.len()),
        distances: Vec::with_capacity(block.len()),
        outside: vec![Vec::with_capacity(block.len()); folds.len()],
    };
    let mut distances = vec![0.0; n];
    for (row, products) in block.zip(products.axis_iter(Axis(0))) {
        for ((distance, square), product) in distances.iter_mut().zip(&squares).zip(products) {
            *distance = square - 2.0 * product;
        }
        distances[row] = f64::INFINITY;
        let near = smallest(&distances, k);
        let own = features.row(row);
        let mut near: Vec<(f64, usize)> = near
            .into_iter()
            .map(|other| (distance(own, features.row(other)), other))
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found
            .distances
            .push(near.iter().map(|near| near.0).collect());
        found
            .neighbours
            .push(near.iter().map(|near| near.1).collect());
        for (folds, outside) in folds.iter().zip(&mut found.outside) {
            outside.push(nearest_outside(&distances, folds, row));
        }
    }
    found
}

/// Returns the index of the smallest distance among rows that are in a fold other than the fold of `row`.
fn nearest_outside(distances: &[f64], folds: &[usize], row: usize) -> Option<usize> {
    let own = folds[row];
    if own == usize::MAX {
        return None;
    }
    let (mut nearest, mut least) = (None, f64::INFINITY);
    for (other, (&distance, &fold)) in distances.iter().zip(folds).enumerate() {
        if distance < least && fold != own && fold != usize::MAX {
            (nearest, least) = (Some(other), distance);
        }
    }
    nearest
}

/// Returns the indices of the k smallest values.
fn smallest(values: &[f64], k: usize) -> Vec<usize> {
    let mut kept: Vec<(f64, usize)> = Vec::with_capacity(k + 1);
    let mut bar = f64::INFINITY;
    for (index, &value) in values.iter().enumerate() {
        if value < bar || (kept.len() < k && value < f64::INFINITY) {
            let place = kept.partition_point(|&(kept, _)| kept <= value);
            kept.insert(place, (value, index));
            kept.truncate(k);
            if kept.len() == k {
                bar = kept[k - 1].0;
            }
        }
    }
    kept.into_iter().map(|(_, index)| index).collect()
}

fn distance(a: ArrayView1<f64>, b: ArrayView1<f64>) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::streams::Streams;
    use ndarray::Array2;
    use rand::Rng;

    #[test]
    fn nearest_rows_are_those_of_all_pairs() {
        let mut rng = 7_u64.named("rows").rng();
        let rows = Array2::from_shape_simple_fn((60, 5), || rng.r#gen::<f64>());
        let folds: Vec<Option<usize>> = (0..60)
            .map(|row| (row % 7 != 6).then_some(row % 3))
            .collect();
        let found = nearest_rows(rows.view(), 4, std::slice::from_ref(&folds), 10..40);
        for row in 10..40 {
            let mut all: Vec<(f64, usize)> = (0..60)
                .filter(|&other| other != row)
                .map(|other| (distance(rows.row(row), rows.row(other)), other))
                .collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            let near: Vec<usize> = all[..4].iter().map(|near| near.1).collect();
            assert_eq!(found.neighbours[row - 10], near);
            assert_eq!(found.distances[row - 10][0], all[0].0);
            let is_outside = |other: usize| folds[other].is_some() && folds[other] != folds[row];
            let outside = all.iter().find(|near| is_outside(near.1));
            let outside = outside.map(|near| near.1).filter(|_| folds[row].is_some());
            assert_eq!(found.outside[0][row - 10], outside);
        }
    }
}
