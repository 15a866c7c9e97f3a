//! Mean and largest norm of training rows, computed in one pass.

use ndarray::{Array1, ArrayView2};

use crate::Result;
use crate::dataset::check_features;

/// Number of partial sums that are computed in parallel and independently of each other.
const LANES: usize = 8;

/// Mean and largest norm of the training rows (n × m).
#[derive(Clone, Debug)]
pub(crate) struct RowStatistics {
    /// Mean of all rows (m values).
    pub mean: Array1<f64>,
    /// Largest squared norm of a row; infinite if the value exceeds the range of f64.
    pub largest_norm: f64,
}

impl RowStatistics {
    /// Computes the mean and the largest norm in one pass, and checks that all features are finite.
    ///
    /// # Errors
    /// If there are no rows or columns, or a feature is NaN or infinite; the error names its row and column.
    pub fn new(features: ArrayView2<f64>) -> Result<Self> {
        let mut sums = vec![0.0; features.ncols()];
        let (mut largest_norm, mut all_finite) = (0.0_f64, !features.is_empty());
        for row in features.rows() {
            let norm = match row.as_slice() {
                Some(row) => add_row(&mut sums, row),
                None => add_row(&mut sums, &row.to_vec()),
            };
            all_finite &= norm.is_finite();
            largest_norm = largest_norm.max(norm);
        }
        if !all_finite {
            // The statistics are also not finite if the features are finite but too large to square.
            check_features(features)?;
            largest_norm = f64::INFINITY;
        }
        Ok(Self {
            mean: Array1::from(sums) / features.nrows() as f64,
            largest_norm,
        })
    }
}

/// Adds a row to the column sums; returns its squared norm.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn add_row(sums: &mut [f64], row: &[f64]) -> f64 {
    let (sums, last_sums) = sums.as_chunks_mut::<LANES>();
    let (row, last) = row.as_chunks::<LANES>();
    let n = sums.len();
    let row = &row[..n];
    let mut squares = [0.0; LANES];
    for at in 0..n {
        for lane in 0..LANES {
            sums[at][lane] += row[at][lane];
            squares[lane] += row[at][lane] * row[at][lane];
        }
    }
    let mut norm = 0.0;
    for square in squares {
        norm += square;
    }
    for at in 0..last_sums.len() {
        last_sums[at] += last[at];
        norm += last[at] * last[at];
    }
    norm
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{Array2, Axis, s};

    #[test]
    fn the_statistics_is_the_mean_and_the_largest_squared_length() {
        let all = Array2::from_shape_fn((7, 21), |(i, j)| ((i * 21 + j) as f64 * 1.7).sin());
        for features in [all.view(), all.slice(s![.., ..;2]), all.slice(s![..3, ..8])] {
            let statistics = RowStatistics::new(features).unwrap();
            let mean = features.mean_axis(Axis(0)).unwrap();
            let close = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-15;
            let centre = statistics.mean.clone();
            assert!(centre.iter().zip(&mean).all(close));
            let norms = features.rows().into_iter().map(|row| row.dot(&row));
            let largest = norms.fold(0.0, f64::max);
            assert!((statistics.largest_norm - largest).abs() < 1e-13);
        }
    }

    #[test]
    fn what_is_not_finite_is_named_and_what_is_only_large_is_not() {
        let mut features = Array2::from_elem((3, 20), 1e200);
        assert_eq!(
            RowStatistics::new(features.view()).unwrap().largest_norm,
            f64::INFINITY
        );
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            features[[1, 17]] = bad;
            let error = RowStatistics::new(features.view()).unwrap_err().to_string();
            assert!(error.starts_with("features, row 1, column 17: "), "{error}");
        }
        assert!(RowStatistics::new(Array2::zeros((0, 3)).view()).is_err());
        assert!(RowStatistics::new(Array2::zeros((3, 0)).view()).is_err());
    }
}
