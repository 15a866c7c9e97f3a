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
