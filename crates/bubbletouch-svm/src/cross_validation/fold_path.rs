//! Solutions of a binary problem for all folds and all values of C.
//!
//! Held-out rows keep their position; their label and multiplier are 0. The gradient entry f of a held-out row is its negative decision sum, so the solver's
//! own values score validation rows. The solver starts a fold from the previous fold's multipliers or from the previous C's rescaled multipliers, whichever
//! have the higher objective.

use std::ops::Range;

use super::alpha_seeding::AlphaSeeding;
use crate::gram::matrix::Gram;
use crate::smo::variables::{are_within, signs};
use crate::smo::{Smo, SolverScalar};
use crate::training::Goal;

/// Solutions of a binary problem on the training rows of one fold, for all values of C.
pub(crate) struct FoldPath {
    /// Limit of the coefficient of each row of the problem; 0 if the row is held out by the fold.
    limits: Vec<f64>,
    /// Solutions in ascending order of C. Larger values of C than the last have the last solution.
    pub solutions: Vec<FoldSolution>,
}

/// Solution of a binary problem on one fold, for one value of C or for several consecutive values with equal solutions.
pub(crate) struct FoldSolution {
    /// Range of positions in the ascending list of C values for which this is the solution.
    pub numbers: Range<usize>,
    /// Coefficient β of each row of the problem: label times multiplier, 0 for held-out rows.
    pub beta: Vec<f64>,
    /// Gradient `f = y − Kβ` of the dual objective per row, where K is the Gram matrix; the label y is 0 for held-out rows.
    pub f: Vec<f64>,
    /// Offset ρ that is subtracted from the weighted sum of kernel values.
    pub rho: f64,
    /// Whether the solver stopped at its iteration cap.
    pub is_capped: bool,
}

impl FoldPath {
    /// Solves the problem of a pair of classes on all cross-validation folds; passes each solved fold to a callback. The argument `folds` contains the
    /// limits of the coefficients in each fold, one per row of the Gram matrix. Rows in the range `positive` have the label 1.
    pub fn of_pair<T: SolverScalar>(
        gram: &mut Gram<T>,
        (folds, positive): (Vec<Vec<f64>>, &Range<usize>),
        goal: Goal,
        mut told: impl FnMut(&Self),
    ) {
        let sums = sums_of_folds(gram, &folds, positive);
        let mut last: Option<Self> = None;
        for (limits, sums) in folds.into_iter().zip(sums) {
            let smo = Smo::new(gram, &limits).at_bounds(goal.path[0], &sums);
            let seeding = |last: Self| {
                let seeding = AlphaSeeding::new((&last.limits, &limits), positive);
                (last, seeding)
            };
            let last_and_exchange = last.take().map(seeding);
            let seed = |gram: &mut Gram<'_, T>, number: usize| {
                let (last, seeding) = last_and_exchange.as_ref()?;
                let moved = last.moved(number, (&limits, seeding), gram);
                moved.filter(|(beta, _)| are_within(beta, &limits, goal.path[number]))
            };
            let solutions = along(smo, goal, seed);
            told(last.insert(Self { limits, solutions }));
        }
    }

    /// Solves the problem of one class against all others on all cross-validation folds; passes each solved fold to a callback. If a class is not separable
    /// from the rest, several decision values can be equal within the tolerance. The starting point then determines the predicted class, so each fold starts
    /// from zero, as in training.
    pub fn of_class<T: SolverScalar>(
        gram: &mut Gram<T>,
        folds: Vec<Vec<f64>>,
        goal: Goal,
        mut told: impl FnMut(&Self),
    ) {
        for limits in folds {
            let solutions = along(Smo::new(gram, &limits), goal, |_, _| None);
            told(&Self { limits, solutions });
        }
    }

    /// Returns the starting point of a fold: the previous fold's coefficients β, with the multipliers of removed rows moved to added rows, and the gradient.
    fn moved<T: SolverScalar>(
        &self,
        number: usize,
        (limits, seeding): (&[f64], &AlphaSeeding),
        gram: &mut Gram<T>,
    ) -> Option<(Vec<f64>, Vec<f64>)> {
        let last = self.solutions.len() - 1;
        let FoldSolution { beta, f, .. } = &self.solutions[number.min(last)];
        let moved = seeding.transfer(beta, gram)?;
        let mut moved_f = gram.times(&difference(&moved, beta));
        let (labels, before) = (signs(limits), signs(&self.limits));
        let both = labels.iter().zip(&before);
        for ((moved, f), (label, before)) in moved_f.iter_mut().zip(f).zip(both) {
            *moved = f + ((label - before) - *moved);
        }
        Some((moved, moved_f))
    }
}

/// Solves the problem of one fold for each C in ascending order, until the solution no longer changes with C.
fn along<T: SolverScalar>(
    mut smo: Smo<T>,
    goal: Goal,
    seed: impl Fn(&mut Gram<T>, usize) -> Option<(Vec<f64>, Vec<f64>)>,
) -> Vec<FoldSolution> {
    let n_path = goal.path.len();
    let mut solutions = Vec::with_capacity(n_path);
    for (number, &c) in goal.path.iter().enumerate() {
        let reached = smo.reach(c, goal.tolerance, |gram| seed(gram, number));
        let (beta, f) = smo.variables();
        // If no multiplier is at its upper bound, a larger C does not change the solution.
        let holds_for_larger = reached.is_solved && smo.is_below_limits(c);
        let end = if holds_for_larger { n_path } else { number + 1 };
        solutions.push(FoldSolution {
            numbers: number..end,
            rho: smo.rho(c),
            is_capped: !reached.is_solved,
            beta: beta.to_vec(),
            f: f.to_vec(),
        });
        if end == n_path {
            break;
        }
    }
    solutions
}

/// Returns the product of the Gram matrix with the labels of each fold, given the limits of the coefficients; held-out rows have the label 0.
fn sums_of_folds<T: SolverScalar>(
    gram: &mut Gram<T>,
    folds: &[Vec<f64>],
    positive: &Range<usize>,
) -> Vec<Vec<f64>> {
    let label = |at: usize| if positive.contains(&at) { 1.0 } else { -1.0 };
    let all: Vec<f64> = (0..gram.len()).map(label).collect();
    let held_out = |limits: &Vec<f64>| difference(&all, &signs(limits));
    let held_out: Vec<Vec<f64>> = folds.iter().map(held_out).collect();
    // Rows held out by exactly one fold (the usual case) are already contained in the sums of held-out rows.
    let rest = held_out.iter().fold(all.clone(), |a, b| difference(&a, b));
    let of_held_out: Vec<Vec<f64>> = held_out.iter().map(|rows| gram.times(rows)).collect();
    let mut of_all = gram.times(&rest);
    for sums in &of_held_out {
        of_all.iter_mut().zip(sums).for_each(|(a, b)| *a += b);
    }
    let of_fold = of_held_out.iter().map(|sums| difference(&of_all, sums));
    of_fold.collect()
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    const N: usize = 45;
    const POSITIVE: Range<usize> = 0..20;

    fn kernel(gamma: f64, i: usize, j: usize) -> f64 {
        let at = |i: usize| (i as f64 * 1.7).sin() + if POSITIVE.contains(&i) { 0.4 } else { 0.0 };
        (-gamma * (at(i) - at(j)).powi(2)).exp()
    }

    fn gram(gamma: f64, rows: &[usize]) -> Gram<'static, f64> {
        let values = |(i, j): (usize, usize)| kernel(gamma, rows[i], rows[j]);
        Gram::whole(Array2::from_shape_fn((rows.len(), rows.len()), values).view())
    }

    fn label(at: usize, fold: usize) -> f64 {
        match (at % 3 == fold, POSITIVE.contains(&at)) {
            (true, _) => 0.0,
            (false, true) => 1.0,
            (false, false) => -1.0,
        }
    }

    #[test]
    fn a_fold_is_solved_as_if_it_had_its_rows_alone_and_f_judges_those_held_out() {
        let all: Vec<usize> = (0..N).collect();
        let goal = Goal {
            path: &[0.05, 1.0, 20.0, 400.0],
            tolerance: 1e-9,
            memory: usize::MAX,
        };
        let folds: Vec<Vec<f64>> = (0..3)
            .map(|fold| all.iter().map(|&at| label(at, fold)).collect())
            .collect();
        // A kernel that mixes the classes, and one that isolates each row: then no multiplier reaches a large C.
        for gamma in [1.0, 1e6] {
            let mut whole = gram(gamma, &all);
            let mut fold = 0;
            let mut check = |path: &FoldPath| {
                assert_is_alone((gamma, path), fold % 3, goal);
                assert_eq!(path.solutions.len() < goal.path.len(), gamma > 1.0);
                fold += 1;
            };
            FoldPath::of_pair(&mut whole, (folds.clone(), &POSITIVE), goal, &mut check);
            FoldPath::of_class(&mut whole, folds.clone(), goal, &mut check);
            assert_eq!(fold, 6);
        }
    }

    /// Asserts that the solutions of a fold equal those computed from the fold's training rows only.
    fn assert_is_alone((gamma, path): (f64, &FoldPath), fold: usize, goal: Goal) {
        let rows: Vec<usize> = (0..N).filter(|at| at % 3 != fold).collect();
        let own: Vec<f64> = rows.iter().map(|&at| label(at, fold)).collect();
        let mut part = gram(gamma, &rows);
        let mut alone = Smo::new(&mut part, &own);
        let numbers = path
            .solutions
            .iter()
            .flat_map(|found| found.numbers.clone());
        assert!(numbers.eq(0..goal.path.len()));
        for (number, &c) in goal.path.iter().enumerate() {
            let holds = |found: &&FoldSolution| found.numbers.contains(&number);
            let found = path.solutions.iter().find(holds).unwrap();
            let expected = alone.solve(c, goal.tolerance);
            assert!((found.rho - expected.rho).abs() < 1e-6, "{fold} {c}");
            for at in 0..N {
                let terms = rows.iter().zip(&expected.coefficients);
                let sum: f64 = terms
                    .map(|(&row, beta)| beta * kernel(gamma, row, at))
                    .sum();
                let f = label(at, fold) - sum;
                assert!((found.f[at] - f).abs() < 1e-6, "{fold} {c} {at}");
                assert!(at % 3 != fold || found.beta[at] == 0.0);
            }
        }
    }

    #[test]
    fn sums_of_folds_are_the_gram_matrix_times_their_labels() {
        let mut whole = gram(1.0, &(0..N).collect::<Vec<_>>());
        let label = |at: usize| if POSITIVE.contains(&at) { 1.0 } else { -1.0 };
        let all: Vec<f64> = (0..N).map(label).collect();
        // Rows held out by one fold, by two folds, and by none.
        for held_out in [[0, 1, 2], [0, 1, 1], [0, 0, 0]] {
            let kept = |fold: usize, at: usize| f64::from(u8::from(at % 3 != held_out[fold]));
            let labels = |fold: usize| (0..N).map(|at| all[at] * kept(fold, at)).collect();
            let folds: Vec<Vec<f64>> = (0..3).map(labels).collect();
            let found = sums_of_folds(&mut whole, &folds, &POSITIVE);
            for (found, labels) in found.iter().zip(&folds) {
                for (found, expected) in found.iter().zip(whole.times(labels)) {
                    assert!((found - expected).abs() < 1e-12, "{found} {expected}");
                }
            }
        }
    }
}
