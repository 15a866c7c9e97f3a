//! Gains of rows, relative to rows of equal shape.
//!
//! The strength of a touch depends on its depth and on the gain of the sensor. The shape of its readings, without level and scale, depends on the depth but not on
//! the gain. The relative gain of a row is therefore the logarithm of its strength, minus the mean of the rows of its class with the most similar shapes. A
//! permutation of the rows permutes their relative gains, so that a permutation test of their order is exact.

use crate::statistics::quantile::{of_sorted, quantile};
use ndarray::{Array1, Array2, ArrayView2, Axis};
use std::collections::BTreeMap;

/// Number of rows of similar shape with which a row is compared. More rows reduce the noise of the mean and differ more in their shapes.
const N_SIMILAR: usize = 5;
/// Minimum number of rows of a class.
const MIN_ROWS: usize = 20;
/// Fraction of the relative gains at each end that are clipped, so that few rows without contact do not hide a drift.
const CLIPPED: f64 = 0.05;

/// Relative gains of rows, and the shapes of the rows.
#[derive(Clone, Debug)]
pub struct RelativeGains {
    /// Rows that have a relative gain: rows of large classes whose readings differ.
    pub rows: Vec<usize>,
    /// Natural logarithm of the gain of each of these rows, relative to rows of similar shape.
    pub gains: Vec<f64>,
    /// Readings of each of these rows less their mean, with norm 1.
    pub shapes: Array2<f64>,
}

/// Computes the relative gains of rows of readings. `labels` contains the class of each row. Returns `None` if no class has 20 rows with contact.
pub fn relative_gains(readings: ArrayView2<f64>, labels: &[usize]) -> Option<RelativeGains> {
    let mut shapes = readings.to_owned();
    let mut strengths = Vec::with_capacity(labels.len());
    for mut row in shapes.rows_mut() {
        let mean = row.mean().unwrap_or(0.0);
        row -= mean;
        let norm = row.dot(&row).sqrt();
        row /= if norm > 0.0 { norm } else { 1.0 };
        strengths.push(norm.ln());
    }
    let mut classes = BTreeMap::<usize, Vec<usize>>::new();
    for (row, &label) in labels.iter().enumerate() {
        if strengths[row].is_finite() {
            classes.entry(label).or_default().push(row);
        }
    }
    let mut gains = BTreeMap::new();
    for rows in classes.into_values().filter(|rows| rows.len() >= MIN_ROWS) {
        let own = shapes.select(Axis(0), &rows);
        let similarity = own.dot(&own.t());
        for (place, &row) in rows.iter().enumerate() {
            let mut others: Vec<usize> = (0..rows.len()).filter(|&at| at != place).collect();
            others.select_nth_unstable_by(N_SIMILAR - 1, |&a, &b| {
                let order = similarity[(place, b)].total_cmp(&similarity[(place, a)]);
                order.then(a.cmp(&b))
            });
            let similar = others[..N_SIMILAR].iter();
            let sum: f64 = similar.map(|&at| strengths[rows[at]]).sum();
            gains.insert(row, strengths[row] - sum / N_SIMILAR as f64);
        }
    }
    if gains.is_empty() {
        return None;
    }
    let (rows, mut gains): (Vec<usize>, Vec<f64>) = gains.into_iter().unzip();
    let mut sorted = gains.clone();
    let least = quantile(&mut sorted, CLIPPED);
    let most = of_sorted(&sorted, 1.0 - CLIPPED);
    gains
        .iter_mut()
        .for_each(|gain| *gain = gain.clamp(least, most));
    let shapes = shapes.select(Axis(0), &rows);
    Some(RelativeGains {
        rows,
        gains,
        shapes,
    })
}

/// Returns the means of rows that follow each other in their class and share a unit, such as the frames of one grasp. Also returns the class of each mean. Means are
/// in the order of the first of their rows.
pub fn means_of_runs(
    rows: ArrayView2<f64>,
    labels: &[usize],
    units: &[usize],
) -> (Array2<f64>, Vec<usize>) {
    let mut runs: Vec<Vec<usize>> = Vec::new();
    let mut last = BTreeMap::<usize, usize>::new();
    for (row, &label) in labels.iter().enumerate() {
        let run = last.get(&label).copied();
        match run.filter(|&run| units[runs[run][0]] == units[row]) {
            Some(run) => runs[run].push(row),
            None => {
                last.insert(label, runs.len());
                runs.push(vec![row]);
            }
        }
    }
    let mut means = Array2::zeros((runs.len(), rows.ncols()));
    for (mut mean, run) in means.rows_mut().into_iter().zip(&runs) {
        let of_run = rows.select(Axis(0), run).mean_axis(Axis(0));
        mean.assign(&of_run.unwrap_or_else(|| Array1::zeros(rows.ncols())));
    }
    let labels = runs.iter().map(|run| labels[run[0]]).collect();
    (means, labels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;
    use rand_distr::StandardNormal;

    /// Bumps of three widths, whose strength depends on their depth.
    #[test]
    fn relative_gains_are_those_of_the_sensor_and_not_of_the_depth() {
        let mut rng = Seed::new(5).named("gains").rng();
        let n = 240;
        let labels: Vec<usize> = (0..n).map(|row| row % 3).collect();
        let gains: Vec<f64> = (0..n).map(|_| rng.gen_range(-0.1..0.1)).collect();
        let mut readings = Array2::zeros((n, 30));
        for (row, mut reading) in readings.rows_mut().into_iter().enumerate() {
            let depth: f64 = rng.gen_range(0.5..1.5);
            let width = (2 + labels[row]) as f64 * depth;
            for (place, x) in reading.iter_mut().enumerate() {
                let away = (place as f64 - 14.5).abs() / width;
                let noise: f64 = rng.sample(StandardNormal);
                *x = 3.0 + gains[row].exp() * depth * (1.0 - away).max(0.0) + 1e-3 * noise;
            }
        }
        let found = relative_gains(readings.view(), &labels).unwrap();
        assert_eq!(found.rows.len(), n);
        let found = Array1::from_vec(found.gains);
        let gains = Array1::from_vec(gains);
        let correlation = (&found - found.mean().unwrap()).dot(&(&gains - gains.mean().unwrap()))
            / (n as f64 * found.std(0.0) * gains.std(0.0));
        assert!(correlation > 0.7, "{correlation}");
    }

    #[test]
    fn runs_end_where_the_unit_of_a_class_changes() {
        let rows = Array2::from_shape_fn((6, 1), |(row, _)| row as f64);
        // Class 0 has rows 0, 2, 4 of the units 7, 7, 8; class 1 has rows 1, 3, 5 of the units 7, 9, 9.
        let (means, labels) = means_of_runs(rows.view(), &[0, 1, 0, 1, 0, 1], &[7, 7, 7, 9, 8, 9]);
        assert_eq!(means.column(0).to_vec(), [1.0, 1.0, 4.0, 4.0]);
        assert_eq!(labels, [0, 1, 1, 0]);
    }
}
