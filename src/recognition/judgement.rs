//! Which validation rows of a fold are recognised, without all decision values.
//!
//! One-vs-one elects the class with most votes. A row that its own class wins in each of that class's problems is recognised,
//! whatever the others say: every other class has lost one. So of a problem between two classes only the values of their own
//! rows are needed, until a row loses; the values of all problems are summed for rows that have lost one. Most of those lose
//! at small C: rows are kept in the order of the last C at which they do, so that those still open are the first ones.

use std::ops::Range;
use std::rc::Rc;

use ndarray::ArrayView2;

use crate::recognition::followed_sums::{Sums, add_rows, class_sums};
use crate::recognition::scalar::Scalar;
use crate::recognition::svm::Multiclass;
use crate::recognition::transposed::write_columns;
use crate::recognition::voting::Ballot;

/// What validation needs of a problem's solution.
pub(crate) struct Solved {
    /// β of the problem's rows; `None` where it is that of the last C.
    pub beta: Option<Rc<[f64]>>,
    /// ρ.
    pub rho: f64,
    /// Whether the solver stopped at its cap.
    pub is_capped: bool,
}

/// A problem of a fold, solved along C.
struct SolvedProblem {
    /// The positive class, and the negative one (`None`: all others), by position.
    problem: (usize, Option<usize>),
    path: Vec<Solved>,
}

/// The validation rows of a fold, and its problems as they are solved.
pub(crate) struct Judgement<'a> {
    /// Rows whose class is trained on, ascending, with the position of that class.
    rows: Vec<(usize, usize)>,
    /// The rows of each class.
    ranges: &'a [Range<usize>],
    /// Whether each row is trained on.
    is_training: &'a [bool],
    multiclass: Multiclass,
    n_path: usize,
    /// At how many C, from the first on, each row must be looked at in all problems.
    n_open: Vec<usize>,
    problems: Vec<SolvedProblem>,
}

impl<'a> Judgement<'a> {
    /// Of these validation rows, each with the position of its class; all rows of each class, and which of them are trained on;
    /// along so many C.
    pub fn new(
        rows: Vec<(usize, usize)>,
        ranges: &'a [Range<usize>],
        is_training: &'a [bool],
        multiclass: Multiclass,
        n_path: usize,
    ) -> Self {
        let n_open = match multiclass {
            Multiclass::OneVsOne => 0,
            _ => n_path,
        };
        Self {
            n_open: vec![n_open; rows.len()],
            rows,
            ranges,
            is_training,
            multiclass,
            n_path,
            problems: Vec::new(),
        }
    }

    /// Solves stopped at the iteration cap.
    pub fn n_capped(&self) -> usize {
        let solved = self.problems.iter().flat_map(|problem| &problem.path);
        solved.filter(|solved| solved.is_capped).count()
    }

    /// Takes a problem's solutions along C, and opens the rows of its two classes that lose it. `members` are the problem's
    /// rows, ascending, with their kernel values.
    pub fn take<T: Scalar>(
        &mut self,
        problem: (usize, Option<usize>),
        members: &[usize],
        kernel: ArrayView2<T>,
        path: Vec<Solved>,
    ) {
        if let (positive, Some(negative)) = problem {
            self.open(positive, true, (members, kernel), &path);
            self.open(negative, false, (members, kernel), &path);
        }
        self.problems.push(SolvedProblem { problem, path });
    }

    /// Opens the rows of one class of a problem that lose it.
    fn open<T: Scalar>(
        &mut self,
        class: usize,
        is_positive: bool,
        (members, kernel): (&[usize], ArrayView2<T>),
        path: &[Solved],
    ) {
        let first = self.rows.partition_point(|row| row.1 < class);
        let own = first..self.rows.partition_point(|row| row.1 <= class);
        let place = |at: usize| members.partition_point(|&row| row < self.rows[at].0);
        let places: Vec<usize> = own.clone().map(place).collect();
        let mut n_open = self.n_open[own].iter_mut();
        let width = kernel.ncols();
        let kernel = kernel.to_slice().expect("a kernel is stored row by row");
        for run in places.chunk_by(|a, b| a + 1 == *b) {
            let columns = run[0]..run[0] + run.len();
            let mut values = vec![T::zero(); run.len()];
            let mut own: Vec<&mut usize> = n_open.by_ref().take(run.len()).collect();
            for (number, solved) in path.iter().enumerate() {
                if let Some(beta) = &solved.beta {
                    let weighing = beta.iter().enumerate().filter(|(_, beta)| **beta != 0.0);
                    let rows = weighing.map(|(at, &beta)| {
                        let row = &kernel[at * width..][..width];
                        (&row[columns.clone()], T::of(beta))
                    });
                    values.fill(T::zero());
                    add_rows(&mut values, rows.collect());
                }
                for (n_open, value) in own.iter_mut().zip(&values) {
                    if (value.wide() > solved.rho) != is_positive {
                        **n_open = (**n_open).max(number + 1);
                    }
                }
            }
        }
    }

    /// Rows recognised, by C, on the kernel values of all rows; `room` is for some of these.
    pub fn n_right<T: Scalar>(
        &self,
        kernel: ArrayView2<T>,
        path: &[f64],
        room: &mut Vec<T>,
    ) -> Vec<usize> {
        let mut open: Vec<usize> = (0..self.rows.len())
            .filter(|&at| self.n_open[at] > 0)
            .collect();
        open.sort_by_key(|&at| std::cmp::Reverse(self.n_open[at]));
        let n_at = |number: usize| open.partition_point(|&at| self.n_open[at] > number);
        let n_at: Vec<usize> = (0..self.n_path).map(n_at).collect();
        let rows: Vec<usize> = open.iter().map(|&at| self.rows[at].0).collect();
        let ballots = self.ballots(columns(kernel, &rows, room), &n_at, path);
        let right = |(&n, ballot): (&usize, Ballot)| {
            let winners = ballot.winners().into_iter().zip(&open[..n]);
            let right = winners.filter(|(winner, at)| *winner == self.rows[**at].1);
            self.rows.len() - n + right.count()
        };
        n_at.iter().zip(ballots).map(right).collect()
    }

    /// The votes of all problems on the first so many columns, by C.
    fn ballots<T: Scalar>(
        &self,
        columns: ArrayView2<T>,
        n_at: &[usize],
        path: &[f64],
    ) -> Vec<Ballot> {
        let ballot = |&n: &usize| Ballot::new(self.ranges.len(), n, self.multiclass);
        let mut ballots: Vec<Ballot> = n_at.iter().map(ballot).collect();
        let of_classes = class_sums(self.ranges, self.is_training, columns);
        for solved in &self.problems {
            let (positive, negative) = solved.problem;
            let places: Vec<usize> = match negative {
                Some(negative) => {
                    let own = self.ranges[positive].clone();
                    own.chain(self.ranges[negative].clone()).collect()
                }
                None => (0..columns.nrows()).collect(),
            };
            let sign =
                |&at: &usize| match (self.is_training[at], self.ranges[positive].contains(&at)) {
                    (false, _) => 0.0,
                    (true, true) => 1.0,
                    (true, false) => -1.0,
                };
            let beta = places.iter().map(sign).collect();
            let mut sums = Sums::of_bounds(&of_classes, solved.problem, beta, columns.ncols());
            for (number, at) in solved.path.iter().enumerate() {
                let n = n_at[number];
                if n == 0 {
                    break;
                }
                sums.truncate(n);
                if let Some(beta) = &at.beta {
                    sums.follow(columns, &places, (beta, path[number]));
                }
                ballots[number].take(solved.problem, sums.values(), at.rho);
            }
        }
        ballots
    }
}

/// Columns of a symmetric matrix: its rows, transposed into `to`.
fn columns<'a, T: Scalar>(
    symmetric: ArrayView2<T>,
    columns: &[usize],
    to: &'a mut Vec<T>,
) -> ArrayView2<'a, T> {
    let row = |&row: &usize| symmetric.row(row).to_slice();
    let row = |at| row(at).expect("a kernel is stored row by row");
    let rows: Vec<&[T]> = columns.iter().map(row).collect();
    let size = (symmetric.nrows(), columns.len());
    to.resize(size.0 * size.1, T::zero());
    write_columns(&rows, to, columns.len());
    ArrayView2::from_shape(size, to).expect("columns fill the room")
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
    fn path(members: &[usize], own: &Range<usize>, is_training: &[bool]) -> Vec<Solved> {
        let beta = |c: f64, at: usize| {
            let size = (c * (0.6 + (at as f64 * 2.3 + c).sin())).clamp(0.0, c);
            let sign = if own.contains(&at) { 1.0 } else { -1.0 };
            if is_training[at] { sign * size } else { 0.0 }
        };
        let solved = |(number, &c): (usize, &f64)| Solved {
            beta: (number != 2 || own.start != 16)
                .then(|| members.iter().map(|&at| beta(c, at)).collect()),
            rho: 0.03 * c,
            is_capped: number == 1,
        };
        C.iter().enumerate().map(solved).collect()
    }

    #[test]
    fn rows_are_recognised_as_the_votes_of_all_problems_say() {
        let kernel = kernel();
        let is_training: Vec<bool> = (0..N).map(|at| at % 4 != 1).collect();
        let class = |at: usize| RANGES.iter().position(|range| range.contains(&at)).unwrap();
        let rows: Vec<(usize, usize)> = (1..N).step_by(4).map(|at| (at, class(at))).collect();
        for multiclass in [Multiclass::OneVsOne, Multiclass::OneVsRest] {
            let mut judgement =
                Judgement::new(rows.clone(), &RANGES, &is_training, multiclass, C.len());
            // Votes of each row, or values, by C.
            let mut scores = vec![vec![[0.0; 4]; rows.len()]; C.len()];
            for (positive, negative) in multiclass.problems(4) {
                let own = RANGES[positive].clone();
                let members: Vec<usize> = match negative {
                    Some(negative) => own.clone().chain(RANGES[negative].clone()).collect(),
                    None => (0..N).collect(),
                };
                let path = path(&members, &own, &is_training);
                let mut beta = path[0].beta.as_ref().unwrap();
                for (solved, scores) in path.iter().zip(&mut scores) {
                    beta = solved.beta.as_ref().unwrap_or(beta);
                    for (&(row, _), scores) in rows.iter().zip(scores) {
                        let terms = members.iter().zip(&beta[..]);
                        let value: f64 = terms.map(|(&at, beta)| beta * kernel[[at, row]]).sum();
                        match negative {
                            None => scores[positive] = value - solved.rho,
                            Some(_) if value > solved.rho => scores[positive] += 1.0,
                            Some(negative) => scores[negative] += 1.0,
                        }
                    }
                }
                let part = |(i, j): (usize, usize)| kernel[[members[i], members[j]]];
                let part = Array2::from_shape_fn((members.len(), members.len()), part);
                judgement.take((positive, negative), &members, part.view(), path);
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
                judgement.n_right(kernel.view(), &C, &mut Vec::new()),
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
