//! A binary problem on the rows of all folds, solved for one fold after the other along C.
//!
//! Rows that a fold holds out keep their place: their label is 0 and so is their multiplier, and their f is less what the
//! decision function adds up to there, so that a fold's rows are judged by what the solver knows already. A fold starts from
//! the multipliers of the last one where the objective is higher there than at the last C's, stretched.

use std::ops::Range;

use crate::recognition::scalar::Scalar;
use crate::recognition::seed::moved;
use crate::recognition::smo::{Dense, Gram, Smo};
use crate::recognition::training::Goal;

/// A fold's problem, solved for every C.
pub(crate) struct FoldPath {
    /// 1 for positive rows, −1 for negative ones, 0 for those that are held out.
    labels: Vec<f64>,
    /// The Gram matrix times the labels.
    sums: Vec<f64>,
    /// By C.
    pub solutions: Vec<FoldSolution>,
}

/// The solution of a fold's problem for one C.
pub(crate) struct FoldSolution {
    /// β of all rows of the problem.
    pub beta: Vec<f64>,
    /// `y − Kβ` of all rows, y being 0 where a row is held out.
    pub f: Vec<f64>,
    /// ρ.
    pub rho: f64,
    /// Whether the solver stopped at its cap.
    pub is_capped: bool,
}

impl FoldPath {
    /// Of a fold with these labels, one a row of the Gram matrix; those of `positive` are of the positive class.
    pub fn of_pair<T: Scalar>(
        gram: &mut Dense<T>,
        (labels, positive): (Vec<f64>, &Range<usize>),
        last: Option<&Self>,
        goal: Goal,
    ) -> Self {
        let sums = match last {
            None => gram.times(&labels),
            Some(last) => {
                let change = gram.times(&difference(&labels, &last.labels));
                let sums = last.sums.iter().zip(change);
                sums.map(|(sum, change)| sum + change).collect()
            }
        };
        let smo = Smo::new(gram, &labels).at_bounds(goal.path[0], &sums);
        let seed = |gram: &mut Dense<T>, number: usize| {
            let last = last.filter(|_| number > 0)?;
            last.moved(number, (&labels, positive), gram)
        };
        let solutions = along(smo, goal, seed);
        Self {
            labels,
            sums,
            solutions,
        }
    }

    /// Of a fold of a class against all others. Classes that no hyperplane parts from the rest have values that are equal
    /// within the tolerance, and the largest wins: there the start decides. So it starts from nothing, as training does.
    pub fn of_class<T: Scalar>(gram: &mut Dense<T>, labels: Vec<f64>, goal: Goal) -> Self {
        let smo = Smo::new(gram, &labels);
        let solutions = along(smo, goal, |_, _| None);
        Self {
            labels,
            sums: Vec::new(),
            solutions,
        }
    }

    /// β and f of one C with the multipliers of lost rows moved to gained ones.
    fn moved<T: Scalar>(
        &self,
        number: usize,
        (labels, positive): (&[f64], &Range<usize>),
        gram: &mut Dense<T>,
    ) -> Option<(Vec<f64>, Vec<f64>)> {
        let FoldSolution { beta, f, .. } = &self.solutions[number];
        let folds = (&self.labels[..], labels);
        let moved = moved(beta, folds, positive, |row| gram.row(row))?;
        let change = gram.times(&difference(&moved, beta));
        let mut f = f.clone();
        for at in 0..f.len() {
            f[at] += (labels[at] - self.labels[at]) - change[at];
        }
        Some((moved, f))
    }
}

/// Solves for every C.
fn along<T: Scalar>(
    mut smo: Smo<Dense<T>>,
    goal: Goal,
    seed: impl Fn(&mut Dense<T>, usize) -> Option<(Vec<f64>, Vec<f64>)>,
) -> Vec<FoldSolution> {
    let path = goal.path.iter().enumerate();
    let solution = |(number, &c): (usize, &f64)| {
        let reached = smo.reach(c, goal.tolerance, |gram| seed(gram, number));
        let (beta, f) = smo.variables();
        FoldSolution {
            rho: smo.rho(c),
            is_capped: !reached.is_solved,
            beta: beta.to_vec(),
            f: f.to_vec(),
        }
    };
    path.map(solution).collect()
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::fit_progress::FitProgress;
    use ndarray::Array2;

    const N: usize = 45;
    const POSITIVE: Range<usize> = 0..20;

    fn kernel(i: usize, j: usize) -> f64 {
        let at = |i: usize| (i as f64 * 1.7).sin() + if POSITIVE.contains(&i) { 0.4 } else { 0.0 };
        (-(at(i) - at(j)).powi(2)).exp()
    }

    fn gram(rows: &[usize]) -> Dense<f64> {
        let values = |(i, j): (usize, usize)| kernel(rows[i], rows[j]);
        let mut gram = Dense::default();
        gram.of_whole(Array2::from_shape_fn((rows.len(), rows.len()), values).view());
        gram
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
        let mut whole = gram(&all);
        let goal = Goal {
            path: &[0.05, 1.0, 20.0, 400.0],
            tolerance: 1e-9,
            memory: usize::MAX,
            progress: FitProgress::default(),
        };
        let mut last: Option<FoldPath> = None;
        for fold in 0..3 {
            let labels: Vec<f64> = all.iter().map(|&at| label(at, fold)).collect();
            let rows: Vec<usize> = (0..N).filter(|at| at % 3 != fold).collect();
            let own: Vec<f64> = rows.iter().map(|&at| labels[at]).collect();
            let mut part = gram(&rows);
            let mut alone = Smo::new(&mut part, &own);
            let of_class = FoldPath::of_class(&mut whole, labels.clone(), goal);
            let path = FoldPath::of_pair(&mut whole, (labels, &POSITIVE), last.as_ref(), goal);
            for (number, &c) in goal.path.iter().enumerate() {
                let expected = alone.solve(c, goal.tolerance);
                for found in [&path.solutions[number], &of_class.solutions[number]] {
                    assert!((found.rho - expected.rho).abs() < 1e-6, "{fold} {c}");
                    for at in 0..N {
                        let terms = rows.iter().zip(&expected.coefficients);
                        let sum: f64 = terms.map(|(&row, beta)| beta * kernel(row, at)).sum();
                        let f = label(at, fold) - sum;
                        assert!((found.f[at] - f).abs() < 1e-6, "{fold} {c} {at}");
                    }
                    assert!(
                        all.iter()
                            .all(|at| at % 3 != fold || found.beta[*at] == 0.0)
                    );
                }
            }
            last = Some(path);
        }
    }
}
