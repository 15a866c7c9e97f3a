//! Cross-validation of a whole grid of C and kernels on one matrix of products.
//!
//! All folds and all candidates are parts of the same n × n products: a kernel is made of them once, each fold's problems
//! are gathered from that, and along C each solution starts from the last, the first from all multipliers at their bounds.
//! A problem's decision values are sums of its support vectors' rows over all validation rows at once; from one C to the
//! next they are [followed](crate::recognition::followed_sums), and counted as votes right away.

use std::ops::Range;

use ndarray::{Array2, ArrayView2, ArrayViewMut1};

use crate::recognition::dataset::Dataset;
use crate::recognition::followed_sums::{Sums, class_sums};
use crate::recognition::kernel::KernelFunction;
use crate::recognition::scalar::Scalar;
use crate::recognition::smo::{Part, Room, Runs, Smo};
use crate::recognition::sorted::Sorted;
use crate::recognition::split::Split;
use crate::recognition::svm::Multiclass;
use crate::recognition::training::Goal;
use crate::recognition::voting::Ballot;

/// Training rows and their division into folds.
pub(crate) struct Grid<'a, T> {
    /// The rows, by class.
    pub sorted: &'a Sorted<T>,
    /// The same rows, in their own order.
    pub data: &'a Dataset,
    /// How they are divided, by their own numbers; a row counts once in a fold.
    pub folds: &'a [Split],
    /// One-vs-one or one-vs-rest.
    pub multiclass: Multiclass,
}

/// Folds whose solutions are held at once: as many as are usual, so that many take no more memory.
const FOLDS_AT_ONCE: usize = 8;

/// A fold in terms of sorted rows.
struct Fold {
    /// Training rows, class by class.
    training: Vec<usize>,
    /// Each class that has any, and which of them are its.
    classes: Vec<(usize, Range<usize>)>,
    validation: Vec<usize>,
}

impl Fold {
    /// The places among the training rows of those that take part in a problem.
    fn places(&self, (positive, negative): (usize, Option<usize>)) -> Vec<usize> {
        let of_class = |class: usize| self.classes[class].1.clone();
        match negative {
            Some(negative) => of_class(positive).chain(of_class(negative)).collect(),
            None => (0..self.training.len()).collect(),
        }
    }

    /// Whether each of these is positive.
    fn is_positive(&self, problem: (usize, Option<usize>)) -> Vec<bool> {
        let own = &self.classes[problem.0].1;
        let places = self.places(problem);
        places.iter().map(|at| own.contains(at)).collect()
    }
}

/// The solutions of one problem, by C.
type Path = Vec<Solved>;

/// What validation needs of a solution.
struct Solved {
    c: f64,
    /// `None` where they are those of the last C.
    coefficients: Option<Vec<f64>>,
    rho: f64,
    is_capped: bool,
}

impl<T: Scalar> Grid<'_, T> {
    /// Validation rows recognised, over all folds, per kernel and C (kernels.len() × path.len()), and solves stopped at the
    /// iteration cap.
    pub fn n_correct(&self, kernels: &[KernelFunction], goal: Goal) -> (Array2<usize>, usize) {
        let all = self.sorted.points().all();
        let products = all.products(all);
        let folds: Vec<Fold> = self.folds.iter().map(|split| self.fold(split)).collect();
        let mut counts = Array2::zeros((kernels.len(), goal.path.len()));
        let mut n_capped = 0;
        let mut values = products.clone();
        for (kernel, mut counts) in kernels.iter().zip(counts.rows_mut()) {
            values.assign(&products);
            all.apply(values.view_mut(), all, kernel);
            for folds in folds.chunks(FOLDS_AT_ONCE) {
                for (fold, paths) in folds.iter().zip(self.solve(folds, values.view(), goal)) {
                    n_capped += paths.iter().flatten().filter(|at| at.is_capped).count();
                    self.validate(fold, values.view(), &paths, counts.view_mut());
                }
            }
        }
        (counts, n_capped)
    }

    fn fold(&self, split: &Split) -> Fold {
        let place = self.sorted.place();
        let mut is_training = vec![false; place.len()];
        split
            .train
            .iter()
            .for_each(|&row| is_training[place[row]] = true);
        let (mut training, mut classes) = (Vec::new(), Vec::new());
        for (class, range) in self.sorted.classes_and_ranges() {
            let first = training.len();
            training.extend(range.filter(|&row| is_training[row]));
            if training.len() > first {
                classes.push((class, first..training.len()));
            }
        }
        let mut validation: Vec<usize> = split.test.iter().map(|&row| place[row]).collect();
        validation.sort_unstable();
        Fold {
            training,
            classes,
            validation,
        }
    }

    /// The solutions of each fold's problems along C. A problem is solved for all folds in turn: they share most of its rows.
    fn solve(&self, folds: &[Fold], kernel: ArrayView2<T>, goal: Goal) -> Vec<Vec<Path>> {
        let problems = |fold: &Fold| self.multiclass.problems(fold.classes.len());
        let problems: Vec<Vec<_>> = folds.iter().map(problems).collect();
        let n_problems = problems.iter().map(Vec::len).max().unwrap_or(0);
        let mut paths: Vec<Vec<Path>> = folds.iter().map(|_| Vec::new()).collect();
        let mut room = Room::new();
        for number in 0..n_problems {
            for ((fold, problems), paths) in folds.iter().zip(&problems).zip(&mut paths) {
                if let Some(&problem) = problems.get(number) {
                    paths.push(path(fold, problem, kernel, goal, &mut room));
                }
            }
        }
        paths
    }

    /// Adds a fold's validation rows recognised to the counts, by C.
    fn validate(
        &self,
        fold: &Fold,
        kernel: ArrayView2<T>,
        paths: &[Path],
        mut counts: ArrayViewMut1<usize>,
    ) {
        let n_classes = fold.classes.len();
        let n_rows = fold.validation.len();
        let mut ballots = vec![Ballot::new(n_classes, n_rows, self.multiclass); counts.len()];
        let held_out = gather_all(kernel, &fold.training, &fold.validation);
        let of_classes = class_sums(fold.classes.iter().map(|(_, range)| range), &held_out);
        for (problem, path) in self.multiclass.problems(n_classes).into_iter().zip(paths) {
            let places = fold.places(problem);
            let mut sums = Sums::of_bounds(&of_classes, problem, &fold.is_positive(problem));
            for (ballot, at) in ballots.iter_mut().zip(path) {
                if let Some(beta) = &at.coefficients {
                    sums.follow(&held_out, &places, (beta, at.c));
                }
                ballot.take(problem, sums.values(), at.rho);
            }
        }
        for (count, ballot) in counts.iter_mut().zip(&ballots) {
            *count += self.n_right(fold, ballot);
        }
    }

    /// Validation rows whose votes are for their own class.
    fn n_right(&self, fold: &Fold, ballot: &Ballot) -> usize {
        let winners = ballot.winners().into_iter().zip(&fold.validation);
        let is_right = |&(winner, &row): &(usize, &usize)| {
            fold.classes[winner].0 == self.data.targets[self.sorted.order()[row]]
        };
        winners.filter(is_right).count()
    }
}

/// Solves one problem of a fold for every C.
fn path<T: Scalar>(
    fold: &Fold,
    problem: (usize, Option<usize>),
    kernel: ArrayView2<T>,
    goal: Goal,
    room: &mut Room<T>,
) -> Path {
    let places = fold.places(problem);
    let rows: Vec<usize> = places.iter().map(|&at| fold.training[at]).collect();
    let is_positive = fold.is_positive(problem);
    let mut gram = Part::new(&kernel, &rows, room);
    let mut smo = Smo::new(&mut gram, &is_positive).from_bounds(goal.path[0]);
    let mut last = Vec::new();
    let solved = goal.path.iter().map(|&c| {
        let solution = smo.solve(c, goal.tolerance);
        let is_new = solution.coefficients != last;
        last.clone_from(&solution.coefficients);
        Solved {
            c,
            coefficients: is_new.then_some(solution.coefficients),
            rho: solution.rho,
            is_capped: solution.is_capped,
        }
    });
    solved.collect()
}

/// Rows and columns of a larger matrix.
fn gather_all<T: Scalar>(whole: ArrayView2<T>, rows: &[usize], columns: &[usize]) -> Array2<T> {
    let mut part = Array2::zeros((rows.len(), columns.len()));
    let runs = Runs::new(columns);
    for (&row, mut to) in rows.iter().zip(part.rows_mut()) {
        let from = whole
            .row(row)
            .to_slice()
            .expect("a product is stored row by row");
        runs.copy(from, to.as_slice_mut().expect("a new array is contiguous"));
    }
    part
}
