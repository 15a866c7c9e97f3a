//! Cross-validation of a whole grid of C and kernels on one matrix of products.
//!
//! All folds and all candidates are parts of the same n × n products: a kernel is made of them once, each fold's problems
//! are gathered from that, and along C each solution starts from the last. A problem's decision values are sums of its
//! support vectors' rows over all validation rows at once, and are counted as votes right away.

use std::ops::Range;

use ndarray::{Array2, ArrayView2, ArrayViewMut1};

use crate::recognition::dataset::Dataset;
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
        for (kernel, mut counts) in kernels.iter().zip(counts.rows_mut()) {
            let mut values = products.clone();
            all.apply(values.view_mut(), all, kernel);
            for fold in &folds {
                n_capped += self.validate(fold, values.view(), goal, counts.view_mut());
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

    /// Solves a fold's problems for every C, and adds the validation rows recognised to the counts; how many solves stopped
    /// at the iteration cap.
    fn validate(
        &self,
        fold: &Fold,
        kernel: ArrayView2<T>,
        goal: Goal,
        mut counts: ArrayViewMut1<usize>,
    ) -> usize {
        let n_classes = fold.classes.len();
        let n_rows = fold.validation.len();
        let mut ballots = vec![Ballot::new(n_classes, n_rows, self.multiclass); goal.path.len()];
        let held_out = gather_all(kernel, &fold.training, &fold.validation);
        let (mut room, mut n_capped) = (Room::new(), 0);
        let mut sums = vec![T::zero(); n_rows];
        for problem in self.multiclass.problems(n_classes) {
            let places = fold.places(problem);
            let rows: Vec<usize> = places.iter().map(|&at| fold.training[at]).collect();
            let own = &fold.classes[problem.0].1;
            let is_positive: Vec<bool> = places.iter().map(|at| own.contains(at)).collect();
            let mut gram = Part::new(&kernel, &rows, &mut room);
            let mut smo = Smo::new(&mut gram, &is_positive);
            let mut last = Vec::new();
            for (ballot, &c) in ballots.iter_mut().zip(goal.path) {
                let solution = smo.solve(c, goal.tolerance);
                n_capped += usize::from(solution.is_capped);
                // Where no coefficient changed, the values are those of the last C.
                if solution.coefficients != last {
                    weighted_sum(&mut sums, &held_out, &places, &solution.coefficients);
                    last = solution.coefficients;
                }
                ballot.take(problem, &sums, solution.rho);
            }
        }
        for (count, ballot) in counts.iter_mut().zip(&ballots) {
            *count += self.n_right(fold, ballot);
        }
        n_capped
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

/// `Σ β_i row_i` over the rows at these places.
fn weighted_sum<T: Scalar>(sums: &mut [T], rows: &Array2<T>, places: &[usize], beta: &[f64]) {
    sums.fill(T::zero());
    let row = |at: usize| {
        rows.row(at)
            .to_slice()
            .expect("rows were gathered one by one")
    };
    let support = places.iter().zip(beta).filter(|(_, beta)| **beta != 0.0);
    let mut support: Vec<(&[T], T)> = support.map(|(&at, &beta)| (row(at), T::of(beta))).collect();
    // Rows that weigh nothing fill up the last four.
    let n_fours = support.len().div_ceil(4);
    support.resize(4 * n_fours, (row(0), T::zero()));
    for four in support.as_chunks::<4>().0 {
        add_four(sums, four);
    }
}

/// Four rows at once: the sums are read and written a quarter as often.
#[multiversion::multiversion(targets("x86_64+avx2+fma"))]
fn add_four<T: Scalar>(sums: &mut [T], rows: &[(&[T], T); 4]) {
    let n = sums.len();
    let [(a, p), (b, q), (c, r), (d, s)] = *rows;
    let (a, b, c, d) = (&a[..n], &b[..n], &c[..n], &d[..n]);
    for at in 0..n {
        sums[at] += (p * a[at] + q * b[at]) + (r * c[at] + s * d[at]);
    }
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
