//! Inverse curvatures of the dual objective along pairs of variables, one row per variable.
//!
//! The rows are reused for every C and for every fold of a cross-validation.

use crate::linalg::scalar::Scalar;

/// Minimum curvature of the dual objective along a pair of variables, relative to the largest diagonal entry of the Gram matrix. Equal rows with different
/// labels have zero curvature.
const SMALLEST_CURVATURE: f64 = 1e-12;

/// Maximum number of rows for which all inverse curvatures of a Gram matrix are stored (4 MB in f32). For larger matrices, one row is stored.
const MAX_KEPT: usize = 1000;

/// Returns the minimum curvature that pairwise steps use, given the diagonal of the Gram matrix.
fn smallest<T: Scalar>(diagonal: &[T]) -> T {
    let largest = diagonal.iter().fold(T::zero(), |a, &b| a.max(b));
    (T::from_f64(SMALLEST_CURVATURE) * largest).max(T::min_positive_value())
}

/// Inverse curvatures of the dual objective along all pairs of variables, row by row. If the Gram matrix has few rows, each row is stored at first use.
#[derive(Debug, Default)]
pub(crate) struct InverseCurvatures<T> {
    values: Vec<T>,
    /// Whether each row of `values` has been computed. If this list is empty, `values` contains only the row that was requested last.
    is_here: Vec<bool>,
    smallest: T,
}

impl<T: Scalar> InverseCurvatures<T> {
    /// Prepares the storage for another Gram matrix with n rows and the given padded diagonal; reuses the allocated memory.
    pub fn renew(&mut self, n: usize, diagonal: &[T]) {
        let n_kept = if n <= MAX_KEPT { n } else { 0 };
        self.is_here.clear();
        self.is_here.resize(n_kept, false);
        let n_values = n_kept.max(1) * diagonal.len();
        if self.values.len() < n_values {
            self.values.resize(n_values, T::zero());
        }
        self.smallest = smallest(diagonal);
    }

    /// Returns the minimum curvature that pairwise steps use.
    #[inline(always)]
    pub fn smallest(&self) -> T {
        self.smallest
    }

    /// Returns the inverse curvatures of the pairs (i, j) for all variables j, given row i and the diagonal of the Gram matrix.
    #[inline(always)]
    pub fn of_row(&mut self, i: usize, row: &[T], diagonal: &[T]) -> &[T] {
        let (place, is_here) = match self.is_here.get_mut(i) {
            Some(is_here) => (i, std::mem::replace(is_here, true)),
            None => (0, false),
        };
        let values = &mut self.values[place * diagonal.len()..][..diagonal.len()];
        if !is_here {
            write(values, (row, diagonal), (diagonal[i], self.smallest));
        }
        values
    }
}

/// Writes the inverse curvatures `1 / (K_ii + K_jj − 2 K_ij)` of all pairs (i, j) for one row i; `own` is K_ii. Curvatures below `smallest` are replaced by
/// this value.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn write<T: Scalar>(to: &mut [T], (row, diagonal): (&[T], &[T]), (own, smallest): (T, T)) {
    let n = to.len();
    let (row, diagonal) = (&row[..n], &diagonal[..n]);
    let two = T::one() + T::one();
    for at in 0..n {
        let curvature = own + diagonal[at] - two * row[at];
        let curvature = if curvature > smallest {
            curvature
        } else {
            smallest
        };
        to[at] = T::one() / curvature;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverses_are_those_of_the_definition_whether_kept_or_not_and_never_infinite() {
        let row = |i: usize| (0..16).map(move |j| ((i * 5 + j * 3) as f64 * 1.7).sin());
        let diagonal: Vec<f64> = (0..16).map(|i| 2.0 + f64::from(i)).collect();
        for n in [16, MAX_KEPT + 1] {
            let mut inverses = InverseCurvatures::default();
            inverses.renew(n, &diagonal);
            for i in [3, 0, 3, 15, 3] {
                let row: Vec<f64> = row(i).collect();
                for (j, &found) in inverses.of_row(i, &row, &diagonal).iter().enumerate() {
                    let curvature = diagonal[i] + diagonal[j] - 2.0 * row[j];
                    assert_eq!(found, 1.0 / curvature, "{n} {i} {j}");
                }
            }
        }
        // Two equal rows.
        let mut inverses = InverseCurvatures::default();
        inverses.renew(2, &[1.0_f32; 16]);
        let found = inverses.of_row(0, &[1.0; 16], &[1.0; 16]);
        assert!(found.iter().all(|&found| found == 1.0 / 1e-12), "{found:?}");
    }
}
