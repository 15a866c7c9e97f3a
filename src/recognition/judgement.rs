//! Which validation rows of a fold are recognised, without all decision values.
//!
//! One-vs-one elects the class with most votes. A row that its own class wins in each of that class's problems is recognised,
//! whatever the others say: every other class has lost one. A row whose own class has lost some is not, if another class has
//! lost fewer. The class that the own one lost to is asked first, and none further than it has lost too many.

use std::ops::Range;

use ndarray::Array2;

use crate::recognition::class_columns::{ClassColumns, Products};
use crate::recognition::fold_path::FoldSolution;
use crate::recognition::scalar::Scalar;
use crate::recognition::svm::Multiclass;

/// What validation needs of a problem's solution.
struct Solved {
    /// Where β of the rows of its classes is, as [`ClassColumns::spread_some`] lays it out.
    beta: Range<usize>,
    rho: f64,
    is_capped: bool,
}

/// The validation rows of a fold, and its problems as they are solved.
pub(crate) struct Judgement<'a, T> {
    /// Rows whose class is trained on, ascending, with the position of that class.
    rows: Vec<(usize, usize)>,
    columns: &'a ClassColumns,
    /// The classes that are trained on.
    classes: Vec<usize>,
    multiclass: Multiclass,
    /// For each row and C how many problems the row's own class loses, and one that it loses to.
    lost: Array2<(usize, usize)>,
    /// In the order of [`Multiclass::problems`], along C; empty where a class is not trained on.
    problems: Vec<Vec<Solved>>,
    /// β of all problems.
    beta: Vec<T>,
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

    /// Takes a problem's solution for the next C; whether β is that of the last.
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
        self.problems[number].push(Solved {
            beta,
            rho: solution.rho,
            is_capped: solution.is_capped,
        });
    }

    /// Notes which rows of two classes lose at one C, by what the decision function of the pair adds up to before ρ.
    pub fn look(
        &mut self,
        (positive, negative): (usize, usize),
        number: usize,
        (sum, rho): (impl Fn(usize) -> f64, f64),
    ) {
        for (class, rival) in [(positive, negative), (negative, positive)] {
            let first = self.rows.partition_point(|row| row.1 < class);
            let own = first..self.rows.partition_point(|row| row.1 <= class);
            for at in own {
                if (sum(self.rows[at].0) > rho) != (class == positive) {
                    let lost = &mut self.lost[[at, number]];
                    *lost = (lost.0 + 1, rival);
                }
            }
        }
    }

    /// Where the problem of two classes is, the first of which comes first.
    #[inline(always)]
    fn pair(&self, first: usize, second: usize) -> usize {
        let n_classes = self.columns.ranges().len();
        first * (2 * n_classes - first - 1) / 2 + second - first - 1
    }

    /// Rows recognised, by C; `write_row` writes the kernel values of a row with all.
    pub fn n_right(&self, mut write_row: impl FnMut(usize, &mut Vec<T>)) -> Vec<usize> {
        let mut n_right = vec![0; self.lost.ncols()];
        let (mut all, mut values) = (Vec::new(), Vec::new());
        for (&(row, own), lost) in self.rows.iter().zip(self.lost.rows()) {
            let is_pairs = self.multiclass == Multiclass::OneVsOne;
            if !is_pairs || lost.iter().any(|lost| lost.0 > 0) {
                write_row(row, &mut all);
                self.columns.spread(&all, &mut values);
            }
            for (number, (&lost, n_right)) in lost.iter().zip(&mut n_right).enumerate() {
                let is_right = match lost {
                    _ if !is_pairs => largest(self, number, &values) == own,
                    (0, _) => true,
                    lost => is_elected(self, number, &values, (own, lost)),
                };
                *n_right += usize::from(is_right);
            }
        }
        n_right
    }

    /// Whether the first of two classes wins, which may come after the second.
    #[inline(always)]
    fn wins(&self, number: usize, values: &[T], (first, second): (usize, usize)) -> bool {
        let (positive, negative) = (first.min(second), first.max(second));
        let solved = &self.problems[self.pair(positive, negative)][number];
        let own = self.columns.of_class(positive, values);
        let (left, right) = self.beta[solved.beta.clone()].split_at(own.len());
        let others = self.columns.of_class(negative, values);
        let mut products = Products::new();
        products.add(own, left);
        products.add(others, right);
        (products.sum().wide() > solved.rho) == (first == positive)
    }
}

/// Whether a class has most votes on a row, of equals as the first, given the kernel values with it, in how many problems it
/// loses and one that it loses to.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn is_elected<T: Scalar>(
    judgement: &Judgement<T>,
    number: usize,
    values: &[T],
    (own, (n_lost, rival)): (usize, (usize, usize)),
) -> bool {
    let classes = &judgement.classes[..];
    for at in 0..=classes.len() {
        let class = if at == 0 { rival } else { classes[at - 1] };
        // Which would have as many votes, and come first, or more.
        let n_allowed = if class < own { n_lost } else { n_lost - 1 };
        if class == own || (at > 0 && class == rival) {
            continue;
        }
        let mut n_lost = 0;
        for &other in classes {
            if other != class && !judgement.wins(number, values, (class, other)) {
                n_lost += 1;
                if n_lost > n_allowed {
                    break;
                }
            }
        }
        if n_lost <= n_allowed {
            return false;
        }
    }
    true
}

/// The class with the largest decision value on a row, of equals the first.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn largest<T: Scalar>(judgement: &Judgement<T>, number: usize, values: &[T]) -> usize {
    let (mut largest, mut winner) = (f64::NEG_INFINITY, 0);
    for &class in &judgement.classes {
        let solved = &judgement.problems[class][number];
        let beta = &judgement.beta[solved.beta.clone()];
        let mut products = Products::new();
        products.add(values, beta);
        let value = products.sum().wide() - solved.rho;
        if value > largest {
            (largest, winner) = (value, class);
        }
    }
    winner
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::voting::first_maximum;
    use ndarray::Array2;

    const N: usize = 60;
    const C: [f64; 3] = [0.1, 1.0, 10.0];
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
                        judgement.look((positive, negative), number, (sum, rho));
                    }
                    let solution = FoldSolution {
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
            assert_eq!(
                judgement.n_right(|row, to| *to = kernel.row(row).to_vec()),
                expected,
                "{multiclass:?}"
            );
            assert!(
                expected.iter().all(|&n| n > 3 && n < rows.len()),
                "{expected:?}"
            );
            assert_eq!(judgement.n_capped(), multiclass.problems(4).len());
        }
    }
}
