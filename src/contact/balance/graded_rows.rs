//! Normal equations of rows whose sizes differ by twenty powers of ten, without forming them.
//!
//! Springs 10¹² times as stiff as others leave nothing of the soft ones in a sum of outer products. Householder's QR with the largest rows
//! first and its columns pivoted keeps every row to its own last bits \[CH\].
//!
//! \[CH\] Cox, Higham, *Stability of Householder QR factorization for weighted least squares problems*, 1998.

use super::six::Six;

/// R of `P A Π = Q R`, and Qᵀb, of rows (aᵀ, b).
#[derive(Clone, Debug, Default)]
pub(super) struct GradedRows {
    rows: Vec<(Six, f64)>,
    /// Column k of R is column `order[k]` of A.
    order: [usize; 6],
}

impl GradedRows {
    /// No rows yet; those of a rank of 6 must come.
    pub fn clear(&mut self) {
        self.rows.clear();
    }

    /// Adds the row √weight · aᵀ with the right side `b / √weight`, so that `AᵀA` grows by weight · a aᵀ and `Aᵀb` by b · a.
    pub fn add(&mut self, weight: f64, a: &Six, b: f64) {
        let root = weight.sqrt();
        if root > 0.0 {
            self.rows.push((a.map(|x| root * x), b / root));
        }
    }

    /// Makes R.
    pub fn factorise(&mut self) {
        let Self { rows, order } = self;
        let largest = |row: &Six| row.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        rows.sort_by(|a, b| largest(&b.0).total_cmp(&largest(&a.0)));
        *order = [0, 1, 2, 3, 4, 5];
        while rows.len() < 6 {
            rows.push(([0.0; 6], 0.0));
        }
        for k in 0..6 {
            let size = |column: usize| {
                rows[k..]
                    .iter()
                    .map(|(a, _)| a[column] * a[column])
                    .sum::<f64>()
            };
            let sizes: Six =
                std::array::from_fn(|column| if column < k { 0.0 } else { size(column) });
            let pivot = (k..6).fold(k, |best, column| {
                if sizes[column] > sizes[best] {
                    column
                } else {
                    best
                }
            });
            if pivot != k {
                rows.iter_mut().for_each(|(a, _)| a.swap(k, pivot));
                order.swap(k, pivot);
            }
            // The largest entry of the column to the diagonal: the reflection then takes no small row through a large one.
            let below = (k..rows.len()).fold(k, |best, row| {
                if rows[row].0[k].abs() > rows[best].0[k].abs() {
                    row
                } else {
                    best
                }
            });
            rows.swap(k, below);
            reflect(&mut rows[k..], k);
        }
        rows.truncate(6);
    }

    /// d of `AᵀA d = Aᵀb + r`.
    pub fn solve(&self, r: &Six) -> Six {
        let Self { rows, order } = self;
        // Rᵀ z = Πᵀ r, then R x = Qᵀb + z.
        let mut z = [0.0; 6];
        for k in 0..6 {
            let known: f64 = (0..k).map(|i| rows[i].0[k] * z[i]).sum();
            z[k] = over(r[order[k]] - known, rows[k].0[k]);
        }
        let mut found = [0.0; 6];
        for k in (0..6).rev() {
            let known: f64 = (k + 1..6).map(|j| rows[k].0[j] * found[order[j]]).sum();
            found[order[k]] = over(rows[k].1 + z[k] - known, rows[k].0[k]);
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
fn reflect(rows: &mut [(Six, f64)], k: usize) {
    let largest = rows
        .iter()
        .fold(0.0, |most: f64, (a, _)| most.max(a[k].abs()));
    if largest == 0.0 {
        return;
    }
    let length = largest
        * rows
            .iter()
            .map(|(a, _)| (a[k] / largest).powi(2))
            .sum::<f64>()
            .sqrt();
    let first = rows[0].0[k];
    let diagonal = if first > 0.0 { -length } else { length };
    // v = column − diagonal e₁; vᵀv = 2 · length · (length + |first|).
    let head = first - diagonal;
    let half = length * (length + first.abs());
    for column in k + 1..7 {
        let entry = |row: &(Six, f64)| if column < 6 { row.0[column] } else { row.1 };
        let along = head * entry(&rows[0])
            + rows[1..]
                .iter()
                .map(|row| row.0[k] * entry(row))
                .sum::<f64>();
        let factor = along / half;
        for (number, row) in rows.iter_mut().enumerate() {
            let v = if number == 0 { head } else { row.0[k] };
            match column {
                6 => row.1 -= factor * v,
                _ => row.0[column] -= factor * v,
            }
        }
    }
    rows[0].0[k] = diagonal;
    rows[1..].iter_mut().for_each(|row| row.0[k] = 0.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::balance::six::{dot, norm};
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
            let all: Vec<(f64, Six)> = (0..9)
                .map(|k| (if k < 3 { 1e14 } else { 1e-6 }, random()))
                .collect();
            for (weight, a) in &all {
                rows.add(*weight, a, weight * dot(a, &wanted));
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
            for a in &all {
                rows.add(2.0, a, 0.5);
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
