//! Cholesky factorisation in the memory of the caller, without allocations.

/// Lower triangular Cholesky factor L of a symmetric n × n matrix A = L Lᵀ, row after row in a slice; the values above the diagonal have no meaning.
pub(crate) struct RowCholesky<'a> {
    rows: &'a [f64],
    n: usize,
}

impl<'a> RowCholesky<'a> {
    /// Factorises a positive definite matrix, of which only the lower triangle is used, in its place.
    pub(crate) fn new(matrix: &'a mut [f64], n: usize) -> Self {
        for a in 0..n {
            let (above, row) = matrix.split_at_mut(a * n);
            for b in 0..a {
                let other = &above[b * n..=b * n + b];
                row[b] = (row[b] - dot(&row[..b], other)) / other[b];
            }
            row[a] = (row[a] - dot(&row[..a], &row[..a])).sqrt();
        }
        Self { rows: matrix, n }
    }

    /// Solves A x = b in place.
    pub(crate) fn solve(&self, b: &mut [f64]) {
        let row = |a: usize| &self.rows[a * self.n..=a * self.n + a];
        for a in 0..self.n {
            b[a] = (b[a] - dot(&b[..a], row(a))) / row(a)[a];
        }
        for a in (0..self.n).rev() {
            b[a] /= row(a)[a];
            let x = b[a];
            b[..a].iter_mut().zip(row(a)).for_each(|(b, l)| *b -= l * x);
        }
    }
}

/// Returns the dot product of two slices over the length of the shorter slice.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
