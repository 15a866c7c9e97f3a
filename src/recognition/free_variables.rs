//! The optimum of a binary problem over the variables between their bounds, the others left where they are.
//!
//! Pairs of variables come near the optimum in a few steps and then take hundreds to reach it. But once it is known which
//! variables rest on a bound, what is left is a system of linear equations: f is to be equal on all free variables, and the
//! sum of their changes 0. A support vector machine of many features has few of them, so it is solved by elimination. Where
//! that leads beyond a bound, the way ends there and goes on without that variable (an active-set method [Scheinberg 2006]).

use crate::recognition::scalar::Scalar;
use crate::recognition::smo::Gram;

/// Ways to go at most: each ends at the optimum or with one variable fewer.
const MOST_WAYS: usize = 12;
/// Free variables beyond which pairs of variables are faster than equations.
const MOST_FREE: usize = 384;
/// What is left of a row's own kernel value when the rows before are taken from it, at least, as a share of the largest: less is
/// rounding, the row depends on those before, and its variable stays where it is.
const SMALLEST_PIVOT: f64 = 1e-5;
/// Values handled side by side: four registers, so that no addition waits for the one before.
const LANES: usize = 32;

/// Moves the free variables to their optimum, with f: β of the problem's rows, and `f = y − Kβ`. How many ways it took; 0
/// where there are too few or too many free variables.
pub(crate) fn settle_free<T: Scalar, G: Gram<T>>(
    gram: &mut G,
    labels: &[f64],
    (beta, f): (&mut [f64], &mut [f64]),
    c: f64,
) -> u64 {
    let bounds = |i: usize| {
        if labels[i] > 0.0 { (0.0, c) } else { (-c, 0.0) }
    };
    let is_free = |i: usize, beta: &[f64]| beta[i] > bounds(i).0 && beta[i] < bounds(i).1;
    let mut free: Vec<usize> = (0..beta.len()).filter(|&i| is_free(i, beta)).collect();
    let mut changes = vec![0.0; beta.len()];
    let mut equations = Equations::default();
    for n_ways in 0..MOST_WAYS {
        if free.len() < 2 || free.len() > MOST_FREE {
            return n_ways as u64;
        }
        equations.of(gram, &free, f);
        let Some(steps) = equations.solve() else {
            return n_ways as u64;
        };
        // As far as the nearest bound.
        let (mut share, mut blocked) = (1.0, None);
        for (at, (&i, &step)) in free.iter().zip(&steps).enumerate() {
            let bound = if step > 0.0 { bounds(i).1 } else { bounds(i).0 };
            if step * share > 0.0 && beta[i] + step * share >= bound
                || step * share < 0.0 && beta[i] + step * share <= bound
            {
                (share, blocked) = ((bound - beta[i]) / step, Some((at, bound)));
            }
        }
        for (&i, &step) in free.iter().zip(&steps) {
            changes[i] = share * step;
            beta[i] += changes[i];
        }
        for (f, product) in f.iter_mut().zip(gram.times(&changes)) {
            *f -= product;
        }
        let Some((at, bound)) = blocked else {
            return n_ways as u64 + 1;
        };
        let i = free.remove(at);
        (beta[i], changes[i]) = (bound, 0.0);
    }
    MOST_WAYS as u64
}

/// `K Δ + μ = f` of the free variables, for f and for 1 on the right.
#[derive(Default)]
struct Equations {
    n: usize,
    /// Pieces of a row.
    width: usize,
    /// n rows of n + 2 values and what fills up the last piece; what is left of the diagonal is never read.
    values: Vec<[f64; LANES]>,
    /// 1 over the pivots.
    inverse: Vec<f64>,
}

impl Equations {
    /// Takes on those of these variables.
    fn of<T: Scalar, G: Gram<T>>(&mut self, gram: &mut G, free: &[usize], f: &[f64]) {
        self.n = free.len();
        self.width = (self.n + 2).div_ceil(LANES);
        self.values.clear();
        self.values.resize(self.n * self.width, [0.0; LANES]);
        // About their mean: products with 1 are then small.
        let mean = free.iter().map(|&i| f[i]).sum::<f64>() / self.n as f64;
        let rows = self.values.chunks_exact_mut(self.width);
        for (at, to) in rows.enumerate() {
            let to = to.as_flattened_mut();
            let (row, _) = gram.rows(free[at], free[at]);
            for j in at..free.len() {
                to[j] = row[free[j]].wide();
            }
            to[self.n] = f[free[at]] - mean;
            to[self.n + 1] = 1.0;
        }
    }

    /// Δ, whose sum is 0, and 0 where a row depends on those before; `None` where nothing can move.
    fn solve(&mut self) -> Option<Vec<f64>> {
        let n = self.n;
        self.inverse.clear();
        self.inverse.resize(n, 0.0);
        eliminate(&mut self.values, self.width, &mut self.inverse);
        let (mut for_f, mut for_one) = (vec![0.0; n], vec![0.0; n]);
        for j in (0..n).rev() {
            let row = self.values[j * self.width..][..self.width].as_flattened();
            let (mut left_f, mut left_one) = (row[n], row[n + 1]);
            for k in j + 1..n {
                left_f -= row[k] * for_f[k];
                left_one -= row[k] * for_one[k];
            }
            (for_f[j], for_one[j]) = (left_f * self.inverse[j], left_one * self.inverse[j]);
        }
        let mu = for_f.iter().sum::<f64>() / for_one.iter().sum::<f64>();
        for (step, one) in for_f.iter_mut().zip(for_one) {
            *step -= mu * one;
        }
        for_f.iter().all(|step| step.is_finite()).then_some(for_f)
    }
}

/// Makes a symmetric matrix, given right of its diagonal, and what stands beside it triangular, row by row; 1 over the pivots, 0
/// for one that is too small.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn eliminate(values: &mut [[f64; LANES]], width: usize, inverse: &mut [f64]) {
    let mut largest = 0.0_f64;
    for j in 0..inverse.len() {
        largest = largest.max(values[j * width + j / LANES][j % LANES]);
    }
    let mut factors = [0.0; MOST_FREE];
    for i in 0..inverse.len() {
        let (piece, lane) = (i / LANES, i % LANES);
        for j in 0..i {
            factors[j] = values[j * width + piece][lane] * inverse[j];
        }
        for at in piece..width {
            let mut own = values[i * width + at];
            for j in 0..i {
                let above = &values[j * width + at];
                for lane in 0..LANES {
                    own[lane] -= factors[j] * above[lane];
                }
            }
            values[i * width + at] = own;
        }
        let pivot = values[i * width + piece][lane];
        let is_independent = pivot > SMALLEST_PIVOT * largest;
        inverse[i] = if is_independent { 1.0 / pivot } else { 0.0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::smo::{Dense, Smo};
    use ndarray::{Array1, Array2};

    /// Products of n rows of m features with no pattern, the first half apart from the others.
    fn problem(n: usize, m: usize, apart: f64) -> (Array2<f64>, Vec<f64>) {
        let rows = Array2::from_shape_fn((n, m), |(i, j)| {
            let side = if i < n / 2 { apart } else { -apart };
            // The sine's last digits: rows that do not depend on each other.
            (((i * m + j) as f64).sin() * 1e4).fract() + side
        });
        (
            rows.dot(&rows.t()),
            (0..n).map(|i| if i < n / 2 { 1.0 } else { -1.0 }).collect(),
        )
    }

    fn objective(beta: &[f64], f: &[f64], labels: &[f64]) -> f64 {
        let y = |i: usize| if labels[i] > 0.0 { 1.0 } else { -1.0 };
        let terms = (0..f.len()).map(|i| beta[i] * (y(i) + f[i]) / 2.0);
        terms.sum()
    }

    #[test]
    fn free_variables_end_where_f_is_equal_and_no_other_objective_is_higher() {
        for (n, m, apart, c) in [
            (40, 60, 0.1, 10.0),
            (60, 200, 0.3, 1.0),
            (50, 70, 0.0, 0.02),
        ] {
            let (kernel, labels) = problem(n, m, apart);
            let mut gram = Dense::<f64>::default();
            gram.of_whole(kernel.view());
            let mut smo = Smo::new(&mut gram, &labels);
            let rough = smo.reach(c, 0.05, |_| None);
            let (mut beta, mut f) = smo.into_variables();
            assert!(rough.is_solved);
            let before = objective(&beta, &f, &labels);
            let n_ways = settle_free(&mut gram, &labels, (&mut beta, &mut f), c);
            assert!((1..=MOST_WAYS as u64).contains(&n_ways), "{n_ways}");
            assert!(objective(&beta, &f, &labels) >= before);
            assert!(beta.iter().sum::<f64>().abs() < 1e-12 * c * n as f64);
            let product = kernel.dot(&Array1::from(beta.clone()));
            let mut of_free = Vec::new();
            for i in 0..n {
                let (y, signed) = if labels[i] > 0.0 {
                    (1.0, beta[i])
                } else {
                    (-1.0, -beta[i])
                };
                assert!((f[i] - (y - product[i])).abs() < 1e-10);
                assert!((0.0..=c).contains(&signed), "{signed} of {c}");
                if signed > 0.0 && signed < c {
                    of_free.push(f[i]);
                }
            }
            assert!(of_free.len() > 2);
            for f in &of_free {
                assert!((f - of_free[0]).abs() < 1e-9, "{of_free:?}");
            }
        }
    }

    #[test]
    fn of_rows_that_depend_on_each_other_some_move_and_the_objective_rises() {
        // Twenty rows of three features: no equations for more than four free ones.
        let (kernel, labels) = problem(20, 3, 0.0);
        let mut gram = Dense::<f64>::default();
        gram.of_whole(kernel.view());
        let y = |i: usize| if labels[i] > 0.0 { 1.0 } else { -1.0 };
        let mut beta: Vec<f64> = (0..20).map(|i| 0.1 * y(i)).collect();
        let f_of = |beta: &[f64]| -> Vec<f64> {
            let product = kernel.dot(&Array1::from(beta.to_vec()));
            (0..20).map(|i| y(i) - product[i]).collect()
        };
        let mut f = f_of(&beta);
        let before = objective(&beta, &f, &labels);
        let n_ways = settle_free(&mut gram, &labels, (&mut beta, &mut f), 1.0);
        assert!(n_ways > 0);
        assert!(objective(&beta, &f, &labels) > before + 1e-6);
        assert!(beta.iter().sum::<f64>().abs() < 1e-12);
        for (i, (found, expected)) in f.iter().zip(f_of(&beta)).enumerate() {
            assert!((found - expected).abs() < 1e-10);
            assert!((0.0..=1.0).contains(&(y(i) * beta[i])));
        }
    }
}
