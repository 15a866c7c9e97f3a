//! Eigenvalues and eigenvectors of a symmetric matrix, for sizes up to a few hundred.
//!
//! Algorithm: Householder's reduction to tridiagonal form, then the QL iteration with implicit shifts. These are `tred2` and `tql2` of
//! EISPACK (Bowdler, Martin, Reinsch and Wilkinson 1968), here with eigenvectors as rows, which are contiguous in memory.

use ndarray::{Array1, Array2, ArrayView2};

/// Maximum number of QL steps per eigenvalue; EISPACK allows 30, and 3 are typical.
const MAX_STEPS: usize = 60;

/// Returns the eigenvalues of a symmetric matrix, ascending, and the orthonormal eigenvectors, one per row in this order.
pub(crate) fn symmetric_eigen(a: ArrayView2<f64>) -> (Array1<f64>, Array2<f64>) {
    let mut vectors = a.as_standard_layout().into_owned();
    let (mut diagonal, mut beside) = tridiagonalise(&mut vectors);
    diagonalise(&mut diagonal, &mut beside, &mut vectors);
    let n = diagonal.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| diagonal[i].total_cmp(&diagonal[j]));
    let values = order.iter().map(|&i| diagonal[i]).collect();
    (values, vectors.select(ndarray::Axis(0), &order))
}

/// Reduces a symmetric matrix A = Qᵀ T Q to tridiagonal form. Returns the diagonal of T and its off-diagonal (entry i is T[i, i + 1], the last is 0); writes
/// Q to `a`.
fn tridiagonalise(a: &mut Array2<f64>) -> (Vec<f64>, Vec<f64>) {
    let n = a.nrows();
    // Reflections H = 1 − v vᵀ·2/vᵀv, one per step, which clear row `step` to the right of its off-diagonal.
    let mut reflections: Vec<(Array1<f64>, f64)> = Vec::new();
    for step in 0..n.saturating_sub(2) {
        let mut v: Array1<f64> = a.row(step).to_owned();
        v.slice_mut(ndarray::s![..=step]).fill(0.0);
        let norm = v.dot(&v).sqrt();
        let head = v[step + 1];
        // The sign that avoids cancellation.
        v[step + 1] += if head >= 0.0 { norm } else { -norm };
        let square = v.dot(&v);
        let factor = if square > 0.0 { 2.0 / square } else { 0.0 };
        // A ← H A H = A − v wᵀ − w vᵀ with w = p − (factor/2)(pᵀv) v, p = factor · A v.
        let p = a.dot(&v) * factor;
        let w = &p - &(&v * (0.5 * factor * p.dot(&v)));
        for row in step..n {
            let (vi, wi) = (v[row], w[row]);
            let mut row = a.row_mut(row);
            row.scaled_add(-vi, &w);
            row.scaled_add(-wi, &v);
        }
        reflections.push((v, factor));
    }
    let diagonal = a.diag().to_vec();
    let mut beside: Vec<f64> = (1..n).map(|i| a[[i - 1, i]]).collect();
    beside.push(0.0);
    // T = … H₁ H₀ A H₀ H₁ …, so Q = … H₁ H₀.
    let mut q = Array2::eye(n);
    for (v, factor) in &reflections {
        // vᵀQ row by row, since rows lie together in memory.
        let mut projected: Array1<f64> = Array1::zeros(n);
        for (row, &vi) in q.outer_iter().zip(v) {
            projected.scaled_add(factor * vi, &row);
        }
        for (mut row, &vi) in q.outer_iter_mut().zip(v) {
            if vi != 0.0 {
                row.scaled_add(-vi, &projected);
            }
        }
    }
    *a = q;
    (diagonal, beside)
}

/// Computes the eigenvalues of a tridiagonal matrix with diagonal `d` and off-diagonal `e`, and rotates the rows of `vectors` to the eigenvectors. The method
/// is the QL iteration with implicit Wilkinson shifts.
fn diagonalise(d: &mut [f64], e: &mut [f64], vectors: &mut Array2<f64>) {
    let n = d.len();
    for l in 0..n {
        for _ in 0..MAX_STEPS {
            let small = |i: usize| e[i].abs() <= f64::EPSILON * (d[i].abs() + d[i + 1].abs());
            let m = (l..n - 1).find(|&i| small(i)).unwrap_or(n - 1);
            if m == l {
                break;
            }
            ql_step(l, m, d, e, vectors);
        }
    }
}

/// Performs one QL step on rows l to m of the tridiagonal matrix with diagonal `d` and off-diagonal `e`.
fn ql_step(l: usize, m: usize, d: &mut [f64], e: &mut [f64], vectors: &mut Array2<f64>) {
    let g = (d[l + 1] - d[l]) / (2.0 * e[l]);
    let mut g = d[m] - d[l] + e[l] / (g + g.hypot(1.0).copysign(g));
    let (mut sine, mut cosine, mut p) = (1.0, 1.0, 0.0);
    for i in (l..m).rev() {
        let (f, b) = (sine * e[i], cosine * e[i]);
        let r = f.hypot(g);
        e[i + 1] = r;
        if r == 0.0 {
            d[i + 1] -= p;
            e[m] = 0.0;
            return;
        }
        (sine, cosine) = (f / r, g / r);
        g = d[i + 1] - p;
        let r = (d[i] - g) * sine + 2.0 * cosine * b;
        p = sine * r;
        d[i + 1] = g + p;
        g = cosine * r - b;
        let (mut upper, mut lower) =
            vectors.multi_slice_mut((ndarray::s![i, ..], ndarray::s![i + 1, ..]));
        for (u, v) in upper.iter_mut().zip(lower.iter_mut()) {
            (*u, *v) = (cosine * *u - sine * *v, sine * *u + cosine * *v);
        }
    }
    d[l] -= p;
    e[l] = g;
    e[m] = 0.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn symmetric(n: usize) -> Array2<f64> {
        let a = Array2::from_shape_fn((n, n), |(i, j)| ((i * 31 + j * 17) as f64 * 0.37).sin());
        &a + &a.t()
    }

    #[test]
    fn vectors_are_orthonormal_and_rebuild_the_matrix() {
        for n in [1, 2, 3, 10, 57] {
            let a = symmetric(n);
            let (values, vectors) = symmetric_eigen(a.view());
            let unit = vectors.dot(&vectors.t()) - Array2::<f64>::eye(n);
            assert!(unit.iter().all(|e| e.abs() < 1e-12), "{n}");
            let rebuilt = vectors.t().dot(&Array2::from_diag(&values)).dot(&vectors);
            assert!((&rebuilt - &a).iter().all(|e| e.abs() < 1e-11), "{n}");
            assert!(
                values
                    .iter()
                    .zip(values.iter().skip(1))
                    .all(|(a, b)| a <= b)
            );
        }
    }

    #[test]
    fn eigenvalues_of_the_second_difference_matrix_are_those_of_the_textbook() {
        let n = 20;
        let a = Array2::from_shape_fn((n, n), |(i, j): (usize, usize)| match i.abs_diff(j) {
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        });
        let (values, _) = symmetric_eigen(a.view());
        for (k, value) in values.iter().enumerate() {
            let angle = (k + 1) as f64 * std::f64::consts::PI / (n + 1) as f64;
            assert!((value - (2.0 - 2.0 * angle.cos())).abs() < 1e-13);
        }
    }

    #[test]
    fn a_multiple_of_the_identity_and_a_zero_matrix_are_no_trouble() {
        for factor in [0.0, 3.0] {
            let (values, vectors) = symmetric_eigen((Array2::<f64>::eye(6) * factor).view());
            assert!(values.iter().all(|v| *v == factor));
            assert_eq!(vectors.sum(), 6.0);
        }
    }
}
