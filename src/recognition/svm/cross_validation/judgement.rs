//! Which validation rows of a fold are recognised, without all decision values.
//!
//! What its own class's problems say of a row is noted as they are solved; rows that are in doubt then are
//! [put to the vote](crate::recognition::svm::cross_validation::election) of all.

use std::ops::Range;

use ndarray::Array2;

use crate::recognition::svm::Multiclass;
use crate::recognition::svm::cross_validation::fold_path::FoldSolution;
use crate::recognition::svm::gram::class_columns::ClassColumns;
use crate::recognition::svm::linalg::scalar::Scalar;

/// What validation needs of a problem's solution.
#[derive(Clone, PartialEq)]
pub(crate) struct Solved {
    /// Where β of the rows of its classes is, as [`ClassColumns::spread_some`] lays it out.
    pub(crate) beta: Range<usize>,
    pub(crate) rho: f64,
    is_capped: bool,
}

/// The validation rows of a fold, and its problems as they are solved.
pub(crate) struct Judgement<'a, T> {
    /// Rows whose class is trained on, ascending, with the position of that class.
    pub(crate) rows: Vec<(usize, usize)>,
    pub(crate) columns: &'a ClassColumns,
    /// The classes that are trained on.
    pub(crate) classes: Vec<usize>,
    pub(crate) multiclass: Multiclass,
    /// For each row and C how many problems the row's own class loses, and one that it loses to.
    pub(crate) lost: Array2<(usize, usize)>,
    /// In the order of [`Multiclass::problems`], along C; empty where a class is not trained on.
    pub(crate) problems: Vec<Vec<Solved>>,
    /// β of all problems.
    pub(crate) beta: Vec<T>,
    /// Whether any problem's solution is another than for the C before, by C.
    is_new: Vec<bool>,
}

impl<'a, T: Scalar> Judgement<'a, T> {
    /// Of these validation rows, each with the position of its class, and whether each class is trained on; along so many C.
    /// The room is for the solutions.
    pub fn new(
        (rows, is_class): (Vec<(usize, usize)>, &[bool]),
        (columns, mut room): (&'a ClassColumns, Vec<T>),
        multiclass: Multiclass,
        n_path: usize,
    ) -> Self {
        room.clear();
        // As much as solutions may take, so that it is asked for once.
        room.reserve(columns.n_values(multiclass) * n_path);
        let n_problems = multiclass.problems(is_class.len()).len();
        Self {
            lost: Array2::from_elem((rows.len(), n_path), (0, 0)),
            rows,
            columns,
            classes: (0..is_class.len()).filter(|at| is_class[*at]).collect(),
            multiclass,
            problems: (0..n_problems).map(|_| Vec::new()).collect(),
            beta: room,
            is_new: vec![false; n_path],
        }
    }

    /// Solves stopped at the iteration cap.
    pub fn n_capped(&self) -> usize {
        let solved = self.problems.iter().flatten();
        solved.filter(|solved| solved.is_capped).count()
    }

    /// The room that it was given.
    pub fn into_room(self) -> Vec<T> {
        self.beta
    }

    /// Takes a problem's solution for the next C; whether β is that of the last one.
    pub fn take(
        &mut self,
        (positive, negative): (usize, Option<usize>),
        solution: &FoldSolution,
        is_last: bool,
    ) {
        let number = match negative {
            Some(negative) => self.pair(positive, negative),
            None => positive,
        };
        let beta = match self.problems[number].last() {
            Some(last) if is_last => last.beta.clone(),
            _ => {
                let start = self.beta.len();
                let classes = match negative {
                    Some(negative) => vec![positive, negative],
                    None => (0..self.columns.ranges().len()).collect(),
                };
                self.columns
                    .spread_some(&classes, &solution.beta, &mut self.beta);
                start..self.beta.len()
            }
        };
        let solved = Solved {
            beta,
            rho: solution.rho,
            is_capped: solution.is_capped,
        };
        let numbers = &solution.numbers;
        self.is_new[numbers.start] |= self.problems[number].last() != Some(&solved);
        self.problems[number].resize(numbers.end, solved);
    }

    /// Notes which rows of two classes lose at some C, by what the decision function of the pair adds up to before ρ.
    pub fn look(
        &mut self,
        (positive, negative): (usize, usize),
        numbers: Range<usize>,
        (sum, rho): (impl Fn(usize) -> f64, f64),
    ) {
        for (class, rival) in [(positive, negative), (negative, positive)] {
            for at in self.of_class(class) {
                if (sum(self.rows[at].0) > rho) != (class == positive) {
                    for number in numbers.clone() {
                        let lost = &mut self.lost[[at, number]];
                        *lost = (lost.0 + 1, rival);
                    }
                }
            }
        }
    }

    /// Where the problem of two classes is, the first of which comes first.
    #[inline(always)]
    pub(crate) fn pair(&self, first: usize, second: usize) -> usize {
        let n_classes = self.columns.ranges().len();
        first * (2 * n_classes - first - 1) / 2 + second - first - 1
    }

    /// The rows of a class whose kernel values with all are asked for, ascending: their own class has lost some problem.
    pub fn doubtful(&self, class: usize) -> impl Iterator<Item = usize> + '_ {
        let own = self.of_class(class).filter(|&at| self.is_doubtful(at));
        own.map(|at| self.rows[at].0)
    }

    /// Whether all problems say the same of a row as at the C before.
    pub(crate) fn is_as_before(&self, at: usize, number: usize) -> bool {
        let lost = self.lost.row(at);
        number > 0 && !self.is_new[number] && lost[number] == lost[number - 1]
    }

    pub(crate) fn is_doubtful(&self, at: usize) -> bool {
        let is_pairs = self.multiclass == Multiclass::OneVsOne;
        !is_pairs || self.lost.row(at).iter().any(|lost| lost.0 > 0)
    }

    /// Where the rows of a class are.
    pub(crate) fn of_class(&self, class: usize) -> Range<usize> {
        let first = self.rows.partition_point(|row| row.1 < class);
        first..self.rows.partition_point(|row| row.1 <= class)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::svm::predict::voting::first_maximum;
    use ndarray::Array2;

    const N: usize = 60;
    const C: [f64; 4] = [0.1, 1.0, 10.0, 10.0];
    const RANGES: [Range<usize>; 4] = [0..16, 16..30, 30..44, 44..60];

    /// Four classes that overlap on a line.
    fn kernel() -> Array2<f64> {
        let at = |i: usize| (i / 15) as f64 * 0.8 + (i as f64 * 1.7).sin();
        Array2::from_shape_fn((N, N), |(i, j)| (-(at(i) - at(j)).powi(2)).exp())
    }

    /// β with no pattern, 0 where a row is not trained on; the last C's again at some C.
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
        let columns = ClassColumns::new(&RANGES);
        for multiclass in [Multiclass::OneVsOne, Multiclass::OneVsRest] {
            let mut judgement = Judgement::new(
                (rows.clone(), &[true; 4]),
                (&columns, vec![0.0; 7]),
                multiclass,
                C.len(),
            );
            // Votes of each row, or values, by C.
            let mut scores = vec![vec![[0.0; 4]; rows.len()]; C.len()];
            for (positive, negative) in multiclass.problems(4) {
                let own = RANGES[positive].clone();
                let classes = match negative {
                    Some(negative) => vec![positive, negative],
                    None => vec![0, 1, 2, 3],
                };
                let members: Vec<usize> =
                    classes.iter().flat_map(|&at| RANGES[at].clone()).collect();
                let mut last = Vec::new();
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
                    if let Some(negative) = negative {
                        judgement.look((positive, negative), number..number + 1, (sum, rho));
                    }
                    let solution = FoldSolution {
                        numbers: number..number + 1,
                        beta: beta.clone(),
                        f: Vec::new(),
                        rho,
                        is_capped: number == 1,
                    };
                    judgement.take((positive, negative), &solution, last == *beta);
                    last.clone_from(beta);
                }
            }
            let expected: Vec<usize> = scores
                .iter()
                .map(|scores| {
                    let right = rows.iter().zip(scores);
                    right
                        .filter(|(row, scores)| first_maximum(&scores[..]) == row.1)
                        .count()
                })
                .collect();
            let mut found = vec![0; C.len()];
            for class in 0..4 {
                let doubtful: Vec<usize> = judgement.doubtful(class).collect();
                let n_right = judgement.n_right(class, |row, to| {
                    assert!(doubtful.contains(&row));
                    *to = kernel.row(row).to_vec();
                });
                let both = found.iter_mut().zip(n_right);
                both.for_each(|(sum, n_right)| *sum += n_right);
            }
            assert_eq!(found, expected, "{multiclass:?}");
            assert!(
                expected.iter().all(|&n| n > 3 && n < rows.len()),
                "{expected:?}"
            );
            assert_eq!(judgement.n_capped(), multiclass.problems(4).len());
        }
    }
}
