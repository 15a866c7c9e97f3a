//! Dual coordinate descent for the binary linear SVM with hinge loss [Hsieh et al. 2008, algorithm 3; LIBLINEAR].
//!
//! The method minimises `½|w|² − Σ_i a_i` over `0 ≤ a_i ≤ C_i`, with `w = Σ_i y_i a_i x_i`. The coordinates are updated one by one, in random order. Each a_i is
//! set to its optimum `clamp(a_i − G/|x_i|², 0, C_i)` with `G = y_i w·x_i − 1`, and w is updated.
//!
//! Shrinking: a row is skipped if its multiplier is at a bound and its gradient towards the bound exceeds every violation of the last pass. When the
//! remaining rows have converged, all rows are visited again.

use ndarray::{Array1, Array2, ArrayView2, s};
use rand::Rng;

use crate::Result;
use crate::dataset::squared_norms;
use crate::linear_svm::params::LinearSvmParams;

/// Number of partial sums of an inner product; rows are padded to a multiple of this number. With a smaller value, vector units are partly idle; with a larger
/// value, the padding grows without benefit.
const LANES: usize = 8;

/// Limit below which multiplier changes and gradients are treated as rounding errors.
pub(crate) const ROUNDING: f64 = 1e-12;

/// Multipliers of a solved binary problem, and the final state of the solver.
#[derive(Clone, Debug)]
pub(crate) struct Solved {
    /// Multiplier `a_i` of each training row times its label `y_i = ±1`. The weights of the features are the sum of `y_i a_i x_i` over the rows `x_i`.
    pub multipliers: Vec<f64>,
    pub n_passes: usize,
    pub is_capped: bool,
}

/// Training rows, each with an appended bias feature of 1 and padded with zeros to whole lanes, contiguous in f64.
#[derive(Clone, Debug)]
pub(crate) struct Rows {
    values: Array2<f64>,
    squared_norms: Array1<f64>,
}

impl Rows {
    /// Copies the features (n × m), which must be finite, and appends a constant feature for the bias.
    pub(crate) fn new(features: ArrayView2<f64>) -> Result<Self> {
        let (n_rows, m) = features.dim();
        let mut values = Array2::zeros((n_rows, (m + 1).next_multiple_of(LANES)));
        values.slice_mut(s![.., ..m]).assign(&features);
        values.column_mut(m).fill(1.0);
        Ok(Self {
            squared_norms: squared_norms(values.view())?,
            values,
        })
    }

    pub(crate) fn n_rows(&self) -> usize {
        self.squared_norms.len()
    }

    /// Returns the length of a padded row: m + 1, rounded up to whole lanes.
    pub(crate) fn width(&self) -> usize {
        self.values.ncols()
    }

    pub(crate) fn row(&self, row: usize) -> &[f64] {
        let width = self.width();
        &self.values.as_slice().expect("rows are stored one by one")[row * width..][..width]
    }

    /// Returns the squared norm of a row, at least 1 because the row includes the bias feature.
    pub(crate) fn squared_norm(&self, row: usize) -> f64 {
        self.squared_norms[row]
    }
}

/// Solves one binary problem, given the label ±1 and the penalty C_i of each row; returns the label times the multiplier of each row.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
pub(crate) fn solve(
    rows: &Rows,
    (sign, penalties): (&[f64], &[f64]),
    params: &LinearSvmParams,
    rng: &mut impl Rng,
) -> Solved {
    let n_rows = rows.n_rows();
    let mut alpha = vec![0.0; n_rows];
    let mut w = vec![0.0; rows.width()];
    let mut order: Vec<usize> = (0..n_rows).collect();
    let mut n_active = n_rows;
    // Range of the projected gradients of the last pass; rows beyond it are shrunk.
    let mut bounds = (f64::NEG_INFINITY, f64::INFINITY);
    for pass in 1..=params.max_passes {
        let mut seen = (f64::INFINITY, f64::NEG_INFINITY);
        let mut visited = 0;
        while visited < n_active {
            // 32 bits, because the draw takes as long as a short row's product.
            let other = visited + rng.gen_range(0..(n_active - visited) as u32) as usize;
            order.swap(visited, other);
            let i = order[visited];
            let x = rows.row(i);
            let gradient = sign[i] * dot(&w, x) - 1.0;
            let (at_lower, at_upper) = (alpha[i] <= 0.0, alpha[i] >= penalties[i]);
            if (at_lower && gradient > bounds.1) || (at_upper && gradient < bounds.0) {
                n_active -= 1;
                order.swap(visited, n_active);
                continue;
            }
            visited += 1;
            let pushes_out = (at_lower && gradient > 0.0) || (at_upper && gradient < 0.0);
            let projected = if pushes_out { 0.0 } else { gradient };
            seen = (seen.0.min(projected), seen.1.max(projected));
            if projected.abs() > ROUNDING {
                let old = alpha[i];
                alpha[i] = (old - gradient / rows.squared_norm(i)).clamp(0.0, penalties[i]);
                add_scaled(&mut w, (alpha[i] - old) * sign[i], x);
            }
        }
        let has_converged = seen.1 - seen.0 <= params.tolerance;
        if has_converged && n_active == n_rows {
            return solved(alpha, sign, pass, false);
        }
        if has_converged {
            n_active = n_rows;
            bounds = (f64::NEG_INFINITY, f64::INFINITY);
        } else {
            bounds.0 = if seen.0 < 0.0 {
                seen.0
            } else {
                f64::NEG_INFINITY
            };
            bounds.1 = if seen.1 > 0.0 { seen.1 } else { f64::INFINITY };
        }
    }
    solved(alpha, sign, params.max_passes, true)
}

fn solved(alpha: Vec<f64>, sign: &[f64], n_passes: usize, is_capped: bool) -> Solved {
    Solved {
        multipliers: alpha.iter().zip(sign).map(|(a, y)| a * y).collect(),
        n_passes,
        is_capped,
    }
}

/// Returns the inner product `a·b` of two padded rows.
#[inline(always)]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (a.as_chunks::<LANES>().0, b.as_chunks::<LANES>().0);
    let (n, mut sums) = (a.len().min(b.len()), [0.0; LANES]);
    for at in 0..n {
        for lane in 0..LANES {
            sums[lane] += a[at][lane] * b[at][lane];
        }
    }
    sums.iter().sum()
}

/// Adds the row `x`, multiplied by `factor`, to the weights `w`.
#[inline(always)]
pub(crate) fn add_scaled(w: &mut [f64], factor: f64, x: &[f64]) {
    let n = w.len().min(x.len());
    for at in 0..n {
        w[at] += factor * x[at];
    }
}
