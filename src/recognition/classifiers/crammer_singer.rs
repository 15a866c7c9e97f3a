//! The sequential dual method for Crammer–Singer's multi-class linear SVM [Keerthi et al. 2008; LIBLINEAR].
//!
//! Minimise `½ Σ_k |w_k|² + Σ_i Σ_{k ≠ y_i} a_ik` over multipliers with `Σ_k a_ik = 0`, `a_ik ≤ 0` for k ≠ y_i and
//! `a_{i y_i} ≤ C`, where `w_k = Σ_i a_ik x_i`. One row at a time, in random order, all its multipliers take their best
//! values together: with `A = |x_i|²` and `B_k = G_k − A a_ik` they are `min(bound_k, (β − B_k) / A)`, β such that they
//! sum to 0. Classes, and rows with a single class left, are shrunk as in LIBLINEAR.

use ndarray::Array2;
use rand::Rng;

use crate::random::Seed;
use crate::recognition::classifiers::coordinate_descent::{ROUNDING, Rows, add_scaled, dot};
use crate::recognition::classifiers::linear_svm::{LinearSvmParams, Solved};

/// The state of the solver.
struct Problem<'a> {
    rows: &'a Rows,
    label: &'a [usize],
    c: f64,
    /// a, n_rows × n_classes.
    alpha: Array2<f64>,
    /// w with bias and padding, class after class.
    w: Vec<f64>,
    /// For every row, its classes: those before `n_active[row]` are active.
    classes: Array2<usize>,
    n_active: Vec<usize>,
    /// G of the row at hand, in the order of its active classes.
    gradient: Vec<f64>,
    sorted: Vec<f64>,
}

/// Solves for multipliers (n_rows × n_classes). `label` is the position of each row's class.
pub(crate) fn solve(
    rows: &Rows,
    label: &[usize],
    n_classes: usize,
    params: &LinearSvmParams,
    seed: &Seed,
) -> Solved<Array2<f64>> {
    let n_rows = rows.n_rows();
    let mut rng = seed.named("order").rng();
    let mut problem = Problem {
        rows,
        label,
        c: params.c,
        alpha: Array2::zeros((n_rows, n_classes)),
        w: vec![0.0; n_classes * rows.width()],
        classes: Array2::from_shape_fn((n_rows, n_classes), |(_, class)| class),
        n_active: vec![n_classes; n_rows],
        gradient: Vec::with_capacity(n_classes),
        sorted: Vec::with_capacity(n_classes),
    };
    let mut order: Vec<usize> = (0..n_rows).collect();
    let mut n_active = n_rows;
    // What is active is solved to this before everything is looked at again; halved each time.
    let mut level = (10.0 * params.tolerance).max(1.0);
    let mut is_whole = true;
    for pass in 1..=params.max_passes {
        let mut violation = f64::NEG_INFINITY;
        let mut visited = 0;
        while visited < n_active {
            // 32 bits: the draw takes as long as a short row's product.
            let other = visited + rng.gen_range(0..(n_active - visited) as u32) as usize;
            order.swap(visited, other);
            match problem.visit(order[visited]) {
                Some(spread) => {
                    violation = violation.max(spread);
                    visited += 1;
                }
                None => {
                    n_active -= 1;
                    order.swap(visited, n_active);
                }
            }
        }
        if violation >= level {
            is_whole = false;
            continue;
        }
        if violation < params.tolerance && is_whole {
            return Solved {
                multipliers: problem.alpha,
                n_passes: pass,
                is_capped: false,
            };
        }
        n_active = n_rows;
        problem.n_active.fill(n_classes);
        level = (0.5 * level).max(params.tolerance);
        is_whole = true;
    }
    Solved {
        multipliers: problem.alpha,
        n_passes: params.max_passes,
        is_capped: true,
    }
}

impl Problem<'_> {
    /// Solves for the multipliers of one row; the violation it had, or `None` if it is shrunk.
    fn visit(&mut self, i: usize) -> Option<f64> {
        let (rows, width) = (self.rows, self.rows.width());
        let x = rows.row(i);
        self.gradient.clear();
        for place in 0..self.n_active[i] {
            let class = self.classes[[i, place]];
            let margin = if class == self.label[i] { 0.0 } else { 1.0 };
            let w = &self.w[class * width..][..width];
            self.gradient.push(margin + dot(w, x));
        }
        let movable = (0..self.n_active[i]).filter(|&place| !self.is_at_bound(i, place));
        let smallest = movable.fold(f64::INFINITY, |min, place| min.min(self.gradient[place]));
        self.shrink(i, smallest);
        if self.n_active[i] <= 1 {
            return None;
        }
        let largest = self
            .gradient
            .iter()
            .fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        let spread = largest - smallest;
        if spread > ROUNDING {
            self.update(i, x);
        }
        Some(spread.max(0.0))
    }

    fn bound(&self, i: usize, place: usize) -> f64 {
        if self.classes[[i, place]] == self.label[i] {
            self.c
        } else {
            0.0
        }
    }

    fn is_at_bound(&self, i: usize, place: usize) -> bool {
        self.alpha[[i, self.classes[[i, place]]]] >= self.bound(i, place)
    }

    /// Leaves out classes whose multiplier is at its bound and whose gradient keeps it there.
    fn shrink(&mut self, i: usize, smallest: f64) {
        let mut place = 0;
        while place < self.gradient.len() {
            if self.is_at_bound(i, place) && self.gradient[place] < smallest {
                let last = self.gradient.len() - 1;
                self.gradient.swap_remove(place);
                self.classes.swap([i, place], [i, last]);
            } else {
                place += 1;
            }
        }
        self.n_active[i] = self.gradient.len();
    }

    /// The best multipliers of the row's active classes, and the weights that follow.
    fn update(&mut self, i: usize, x: &[f64]) {
        let width = self.rows.width();
        let a = self.rows.squared_norm(i);
        let n_active = self.n_active[i];
        // From here on, B; and B + A·bound, sorted descending, is what β is found from.
        self.sorted.clear();
        for place in 0..n_active {
            let b = self.gradient[place] - a * self.alpha[[i, self.classes[[i, place]]]];
            self.gradient[place] = b;
            self.sorted.push(b + a * self.bound(i, place));
        }
        self.sorted.sort_unstable_by(|p, q| q.total_cmp(p));
        // Σ (B + A·bound − β) over those above β is A·C, also if the row's own class is shrunk (it is then at C).
        let mut beta = self.sorted[0] - a * self.c;
        let mut n_free = 1;
        while n_free < n_active && beta < n_free as f64 * self.sorted[n_free] {
            beta += self.sorted[n_free];
            n_free += 1;
        }
        beta /= n_free as f64;
        for place in 0..n_active {
            let class = self.classes[[i, place]];
            let new = ((beta - self.gradient[place]) / a).min(self.bound(i, place));
            let change = new - self.alpha[[i, class]];
            self.alpha[[i, class]] = new;
            if change.abs() >= ROUNDING {
                add_scaled(&mut self.w[class * width..][..width], change, x);
            }
        }
    }
}
