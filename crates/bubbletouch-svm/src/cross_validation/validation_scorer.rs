//! Scoring of a cross-validation fold: counts the correctly classified validation rows.
//!
//! A row's own class is scored as soon as the problems of this class are solved. If the class wins all its pairs, the row is classified correctly, because
//! every other class has lost a pair. The remaining rows are classified by the votes of all problems, with the matrix products of the module `predict`.

use std::ops::Range;

use ndarray::{Array2, ArrayView2, Axis};

use crate::cross_validation::fold_path::FoldSolution;
use crate::linalg::scalar::Scalar;
use crate::multiclass::Multiclass;
use crate::predict::class_weights::{ClassWeights, weighted_sums};
use crate::predict::voting::Voting;

/// Number of validation rows that are classified together by votes; a larger number needs more memory for kernel values.
const ROWS_AT_ONCE: usize = 512;

/// Counter of correctly classified validation rows of one fold, updated after each binary problem is solved.
pub(crate) struct ValidationScorer<T> {
    multiclass: Multiclass,
    /// All binary problems as pairs (positive class, negative class), in the order of the multi-class strategy.
    problems: Vec<(usize, Option<usize>)>,
    /// Whether the fold has training rows of each class.
    is_class: Vec<bool>,
    /// Validation rows as pairs (row number, position of the class), ascending, without rows whose class has no training rows.
    rows: Vec<(usize, usize)>,
    /// Whether the class of each validation row loses against at least one other class, for each C.
    is_beaten: Array2<bool>,
    /// Coefficients of the support vectors, for each C and class.
    weights: Vec<Vec<ClassWeights<T>>>,
    /// Offset ρ of each decision function, shape n_C × n_problems.
    rho: Array2<f64>,
    /// Whether at least one binary problem has, for each C, a different solution than for the previous C.
    is_new: Vec<bool>,
    n_capped: usize,
}

impl<T: Scalar> ValidationScorer<T> {
    /// Creates a scorer for `n_path` values of C. The argument `rows` contains pairs (validation row, position of its class). For each class, `is_class`
    /// contains whether it has training rows, and `ranges` its row range.
    pub fn new(
        (rows, is_class): (Vec<(usize, usize)>, &[bool]),
        ranges: &[Range<usize>],
        multiclass: Multiclass,
        n_path: usize,
    ) -> Self {
        let problems = multiclass.problems(is_class.len());
        let of_class = |(class, range): (usize, &Range<usize>)| {
            ClassWeights::zeros(class, range.clone(), problems.iter().copied())
        };
        let of_c = || ranges.iter().enumerate().map(of_class).collect();
        Self {
            multiclass,
            is_class: is_class.to_vec(),
            is_beaten: Array2::from_elem((rows.len(), n_path), false),
            rows,
            weights: (0..n_path).map(|_| of_c()).collect(),
            rho: Array2::zeros((n_path, problems.len())),
            is_new: vec![false; n_path],
            n_capped: 0,
            problems,
        }
    }

    /// Returns the number of solver runs in this fold that stopped at the iteration cap.
    pub fn n_capped(&self) -> usize {
        self.n_capped
    }

    /// Adds the solution of a binary problem, given by its number, for one or several values of C.
    pub fn take(&mut self, problem: usize, solution: &FoldSolution) {
        let numbers = solution.numbers.clone();
        self.is_new[numbers.start] = true;
        self.n_capped += usize::from(solution.is_capped) * numbers.len();
        let (positive, negative) = self.problems[problem];
        let classes = match negative {
            Some(negative) => vec![positive, negative],
            None => (0..self.is_class.len()).collect(),
        };
        for number in numbers {
            self.rho[[number, problem]] = solution.rho;
            let mut start = 0;
            for &class in &classes {
                let weights = &mut self.weights[number][class];
                let end = start + weights.vectors.len();
                weights.set(problem, &solution.beta[start..end]);
                if negative.is_some() {
                    let own = weights.vectors.clone();
                    let f = (own, &solution.f[start..end]);
                    self.look(number, (class, class == positive), f, solution.rho);
                }
                start = end;
            }
        }
    }

    /// Records the validation rows of one class that a binary problem assigns to its other class.
    fn look(
        &mut self,
        number: usize,
        (class, is_positive): (usize, bool),
        (own, f): (Range<usize>, &[f64]),
        rho: f64,
    ) {
        let first = self.rows.partition_point(|row| row.1 < class);
        let last = self.rows.partition_point(|row| row.1 <= class);
        for at in first..last {
            let sum = -f[self.rows[at].0 - own.start];
            self.is_beaten[[at, number]] |= (sum > rho) != is_positive;
        }
    }

    /// Returns the number of correctly classified validation rows for each value of the penalty C, given the kernel values of all rows.
    pub fn n_correct(&self, kernel: ArrayView2<T>) -> Vec<usize> {
        let is_settled =
            |at: &usize| self.is_pairs() && !self.is_beaten.row(*at).iter().any(|x| *x);
        let (settled, open): (Vec<usize>, Vec<usize>) = (0..self.rows.len()).partition(is_settled);
        let mut n_correct = vec![settled.len(); self.weights.len()];
        for some in open.chunks(ROWS_AT_ONCE) {
            let rows: Vec<usize> = some.iter().map(|&at| self.rows[at].0).collect();
            let values = kernel.select(Axis(0), &rows);
            let mut n_elected = 0;
            for (number, n_correct) in n_correct.iter_mut().enumerate() {
                if self.is_new[number] {
                    n_elected = self.n_elected(number, some, values.view());
                }
                *n_correct += n_elected;
            }
        }
        n_correct
    }

    /// Returns the number of given rows that are classified correctly: their class wins all its pairs or wins the vote. The argument `values` contains the
    /// kernel values of the rows.
    fn n_elected(&self, number: usize, some: &[usize], values: ArrayView2<T>) -> usize {
        let is_open = |place: &usize| !self.is_pairs() || self.is_beaten[[some[*place], number]];
        let open: Vec<usize> = (0..some.len()).filter(is_open).collect();
        let values = values.select(Axis(0), &open);
        let sums = weighted_sums(&self.weights[number], values.view(), self.problems.len());
        let voting = Voting {
            n_classes: self.is_class.len(),
            multiclass: self.multiclass,
        };
        let winners = voting.elect(&sums, self.rho.row(number), |class| self.is_class[class]);
        let winners = winners.into_iter().zip(&open);
        let n_elected = winners.filter(|(winner, place)| *winner == self.rows[some[**place]].1);
        some.len() - open.len() + n_elected.count()
    }

    fn is_pairs(&self) -> bool {
        self.multiclass == Multiclass::OneVsOne
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::predict::voting::first_maximum;
    use ndarray::Array2;

    const N: usize = 60;
    const C: [f64; 4] = [0.1, 1.0, 10.0, 10.0];
    const RANGES: [Range<usize>; 4] = [0..16, 16..30, 30..44, 44..60];

    /// Returns the kernel matrix of four classes that overlap on a line.
    fn kernel() -> Array2<f64> {
        let at = |i: usize| (i / 15) as f64 * 0.8 + (i as f64 * 1.7).sin();
        Array2::from_shape_fn((N, N), |(i, j)| (-(at(i) - at(j)).powi(2)).exp())
    }

    /// Returns irregular coefficients β of all rows for each C, with 0 for held-out rows; some consecutive C have equal coefficients.
    fn path(members: &[usize], own: &Range<usize>, is_training: &[bool]) -> Vec<Vec<f64>> {
        let beta = |c: f64, at: usize| {
            let size = (c * (0.6 + (at as f64 * 2.3 + c).sin())).clamp(0.0, c);
            let sign = if own.contains(&at) { 1.0 } else { -1.0 };
            if is_training[at] { sign * size } else { 0.0 }
        };
        let of_c = |&c: &f64| members.iter().map(|&at| beta(c, at)).collect();
        C.iter().map(of_c).collect()
    }

    #[test]
    fn rows_are_recognised_as_the_votes_of_all_problems_say() {
        let kernel = kernel();
        let is_training: Vec<bool> = (0..N).map(|at| at % 4 != 1).collect();
        let class = |at: usize| RANGES.iter().position(|range| range.contains(&at)).unwrap();
        let rows: Vec<(usize, usize)> = (1..N).step_by(4).map(|at| (at, class(at))).collect();
        for multiclass in [Multiclass::OneVsOne, Multiclass::OneVsRest] {
            let mut scorer =
                ValidationScorer::new((rows.clone(), &[true; 4]), &RANGES, multiclass, C.len());
            // Votes or decision values of each row, for each C.
            let mut scores = vec![vec![[0.0; 4]; rows.len()]; C.len()];
            for (problem, (positive, negative)) in multiclass.problems(4).into_iter().enumerate() {
                let own = RANGES[positive].clone();
                let classes = match negative {
                    Some(negative) => vec![positive, negative],
                    None => vec![0, 1, 2, 3],
                };
                let members: Vec<usize> =
                    classes.iter().flat_map(|&at| RANGES[at].clone()).collect();
                for (number, beta) in path(&members, &own, &is_training).iter().enumerate() {
                    let rho = 0.03 * C[number];
                    let sum = |row: usize| {
                        let terms = members.iter().zip(beta);
                        terms
                            .map(|(&at, beta)| beta * kernel[[at, row]])
                            .sum::<f64>()
                    };
                    for (&(row, _), scores) in rows.iter().zip(&mut scores[number]) {
                        match negative {
                            None => scores[positive] = sum(row) - rho,
                            Some(_) if sum(row) > rho => scores[positive] += 1.0,
                            Some(negative) => scores[negative] += 1.0,
                        }
                    }
                    let solution = FoldSolution {
                        numbers: number..number + 1,
                        beta: beta.clone(),
                        f: members.iter().map(|&row| -sum(row)).collect(),
                        rho,
                        is_capped: number == 1,
                    };
                    scorer.take(problem, &solution);
                }
            }
            let expected: Vec<usize> = scores
                .iter()
                .map(|scores| {
                    let right = rows.iter().zip(scores);
                    right
                        .filter(|(row, scores)| first_maximum(*scores) == row.1)
                        .count()
                })
                .collect();
            let found = scorer.n_correct(kernel.view());
            assert_eq!(found, expected, "{multiclass:?}");
            assert!(
                expected.iter().all(|&n| n > 3 && n < rows.len()),
                "{expected:?}"
            );
            assert_eq!(scorer.n_capped(), multiclass.problems(4).len());
        }
    }
}
