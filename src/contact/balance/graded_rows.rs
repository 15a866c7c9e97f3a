//! Normal equations of rows whose sizes differ by twenty powers of ten, without forming them.
//!
//! Springs 10¹² times as stiff as others leave nothing of the soft ones in a sum of outer products. Householder's QR with the largest rows
//! first and its columns pivoted keeps every row to its own last bits \[CH\].
//!
//! \[CH\] Cox, Higham, *Stability of Householder QR factorization for weighted least squares problems*, 1998.

use super::symmetric::dot;

/// R of `P A Π = Q R`, and Qᵀb, of rows (aᵀ, b).
#[derive(Clone, Debug, Default)]
pub(super) struct GradedRows {
    n: usize,
    /// n entries of a, and b.
    rows: Vec<Vec<f64>>,
    /// Column k of R is column `order[k]` of A.
    order: Vec<usize>,
}

impl GradedRows {
    /// No rows of n yet; those of a rank of n must come.
    pub fn clear(&mut self, n: usize) {
        self.n = n;
        self.rows.clear();
    }

    /// Adds the row √weight · aᵀ with the right side `b / √weight`, so that `AᵀA` grows by weight · a aᵀ and `Aᵀb` by b · a.
    pub fn add(&mut self, weight: f64, a: impl Iterator<Item = f64>, b: f64) {
        let root = weight.sqrt();
        if root > 0.0 {
            let mut row = Vec::with_capacity(self.n + 1);
            row.extend(a.map(|x| root * x));
            row.push(b / root);
            self.rows.push(row);
        }
    }

    /// Makes R.
    pub fn factorise(&mut self) {
        let Self { n, rows, order } = self;
        let n = *n;
        let largest = |row: &[f64]| row[..n].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        rows.sort_by(|a, b| largest(b).total_cmp(&largest(a)));
        order.clear();
        order.extend(0..n);
        while rows.len() < n {
            rows.push(vec![0.0; n + 1]);
        }
        for k in 0..n {
            let mut sizes = vec![0.0; n];
            for row in &rows[k..] {
                for column in k..n {
                    sizes[column] += row[column] * row[column];
                }
            }
            let pivot = (k..n).fold(k, |best, column| {
                if sizes[column] > sizes[best] {
                    column
                } else {
                    best
                }
            });
            if pivot != k {
                rows.iter_mut().for_each(|row| row.swap(k, pivot));
                order.swap(k, pivot);
            }
            // The largest entry of the column to the diagonal: the reflection then takes no small row through a large one.
            let below = (k..rows.len()).fold(k, |best, row| {
                if rows[row][k].abs() > rows[best][k].abs() {
                    row
                } else {
                    best
                }
            });
            rows.swap(k, below);
            reflect(&mut rows[k..], k);
        }
        rows.truncate(n);
    }

    /// d of `AᵀA d = Aᵀb + r`.
    pub fn solve(&self, r: &[f64]) -> Vec<f64> {
        let Self { n, rows, order } = self;
        // Rᵀ z = Πᵀ r, then R x = Qᵀb + z.
        let mut z = vec![0.0; *n];
        for k in 0..*n {
            let known: f64 = (0..k).map(|i| rows[i][k] * z[i]).sum();
            z[k] = over(r[order[k]] - known, rows[k][k]);
        }
        let mut x = vec![0.0; *n];
        for k in (0..*n).rev() {
            let known = dot(&rows[k][k + 1..*n], &x[k + 1..]);
            x[k] = over(rows[k][*n] + z[k] - known, rows[k][k]);
        }
        let mut found = vec![0.0; *n];
        for (x, &column) in x.iter().zip(order) {
            found[column] = *x;
        }
        found
    }
}

/// 0 along what no row says anything of.
fn over(value: f64, diagonal: f64) -> f64 {
    match diagonal {
        0.0 => 0.0,
        _ => value / diagonal,
    }
}

/// Makes column k below the first of these rows zero.
fn reflect(rows: &mut [Vec<f64>], k: usize) {
    let largest = rows
        .iter()
        .fold(0.0, |most: f64, row| most.max(row[k].abs()));
    if largest == 0.0 {
        return;
    }
    let squares = rows.iter().map(|row| (row[k] / largest).powi(2));
    let length = largest * squares.sum::<f64>().sqrt();
    let first = rows[0][k];
    let diagonal = if first > 0.0 { -length } else { length };
    // v = column − diagonal e₁; vᵀv = 2 · length · (length + |first|).
    rows[0][k] = first - diagonal;
    let half = length * (length + first.abs());
    let mut factors = vec![0.0; rows[0].len()];
    for row in rows.iter().filter(|row| row[k] != 0.0) {
        for (factor, entry) in factors.iter_mut().zip(row).skip(k + 1) {
            *factor += row[k] / half * entry;
        }
    }
    for row in rows.iter_mut().filter(|row| row[k] != 0.0) {
        let head = row[k];
        for (entry, factor) in row.iter_mut().zip(&factors).skip(k + 1) {
            *entry -= factor * head;
        }
        row[k] = 0.0;
    }
    rows[0][k] = diagonal;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::balance::symmetric::{Six, dot, norm};
    use crate::random::Seed;
    use rand::Rng;

    #[test]
    fn soft_rows_beside_rows_ten_to_the_twentieth_as_stiff_keep_their_digits() {
        for case in 0..200 {
            let mut rng = Seed::new(case).named("graded rows").rng();
            let mut random = || -> Six { std::array::from_fn(|_| rng.gen_range(-1.0..1.0)) };
            // Three stiff directions and three soft ones: d is known by what rows say of it.
            let wanted = random();
            let mut rows = GradedRows::default();
            rows.clear(6);
            let all: Vec<(f64, Six)> = (0..9)
                .map(|k| (if k < 3 { 1e14 } else { 1e-6 }, random()))
                .collect();
            for (weight, a) in &all {
                rows.add(*weight, a.iter().copied(), weight * dot(a, &wanted));
            }
            rows.factorise();
            let found = rows.solve(&[0.0; 6]);
            let error: Six = std::array::from_fn(|k| found[k] - wanted[k]);
            assert!(norm(&error) < 1e-9, "case {case}: {error:?}");
        }
    }

    #[test]
    fn a_right_side_of_its_own_is_solved_too() {
        for case in 0..50 {
            let mut rng = Seed::new(case).named("right side").rng();
            let mut random = || -> Six { std::array::from_fn(|_| rng.gen_range(-1.0..1.0)) };
            let all: Vec<Six> = (0..8).map(|_| random()).collect();
            let r = random();
            let mut rows = GradedRows::default();
            rows.clear(6);
            for a in &all {
                rows.add(2.0, a.iter().copied(), 0.5);
            }
            rows.factorise();
            let d = rows.solve(&r);
            for k in 0..6 {
                let left: f64 = all.iter().map(|a| 2.0 * a[k] * dot(a, &d)).sum();
                let right: f64 = r[k] + all.iter().map(|a| 0.5 * a[k]).sum::<f64>();
                assert!((left - right).abs() < 1e-9, "{left} {right}");
            }
        }
    }
}
