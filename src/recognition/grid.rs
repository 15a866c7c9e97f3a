//! Cross-validation of a whole grid of C and kernels on one matrix of products.
//!
//! All folds and all candidates are parts of the same n × n products: a kernel is made of them once, each fold's problems
//! are gathered from that, and along C each solution starts from the last. A problem's decision values are sums of its
//! support vectors' rows over all validation rows at once, and are counted as votes right away.

use ndarray::{Array2, ArrayView2, ArrayViewMut1};

use crate::recognition::dataset::Dataset;
use crate::recognition::kernel::KernelFunction;
use crate::recognition::scalar::Scalar;
use crate::recognition::smo::{Part, Room, Smo};
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
    /// Training rows of each class that has any, with the class.
    training: Vec<(usize, Vec<usize>)>,
    validation: Vec<usize>,
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
        let training = self
            .sorted
            .classes_and_ranges()
            .filter_map(|(class, range)| {
                let rows: Vec<usize> = range.filter(|&row| is_training[row]).collect();
                (!rows.is_empty()).then_some((class, rows))
            });
        let mut validation: Vec<usize> = split.test.iter().map(|&row| place[row]).collect();
        validation.sort_unstable();
        Fold {
            training: training.collect(),
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
        let n_classes = fold.training.len();
        let n_rows = fold.validation.len();
        let mut ballots = vec![Ballot::new(n_classes, n_rows, self.multiclass); goal.path.len()];
        let trained: Vec<usize> = fold
            .training
            .iter()
            .flat_map(|(_, rows)| rows.clone())
            .collect();
        let held_out = gather(kernel, &trained, &fold.validation);
        let mut first = vec![0];
        first.extend(fold.training.iter().scan(0, |sum, (_, rows)| {
            *sum += rows.len();
            Some(*sum)
        }));
        let (mut room, mut n_capped) = (Room::new(), 0);
        let mut sums = vec![T::zero(); n_rows];
        for problem in self.multiclass.problems(n_classes) {
            let of_class = |class: usize| first[class]..first[class + 1];
            // Positions among the training rows of the fold.
            let positions: Vec<usize> = match problem.1 {
                Some(negative) => of_class(problem.0).chain(of_class(negative)).collect(),
                None => (0..trained.len()).collect(),
            };
            let rows: Vec<usize> = positions.iter().map(|&at| trained[at]).collect();
            let own = of_class(problem.0);
            let is_positive: Vec<bool> = positions.iter().map(|at| own.contains(at)).collect();
            let mut gram = Part::new(&kernel, &rows, &mut room);
            let mut smo = Smo::new(&mut gram, &is_positive);
            let mut last = Vec::new();
            for (ballot, &c) in ballots.iter_mut().zip(goal.path) {
                let solution = smo.solve(c, goal.tolerance);
                n_capped += usize::from(solution.is_capped);
                // Where no coefficient changed, the values are those of the last C.
                if solution.coefficients != last {
                    weighted_sum(&mut sums, &held_out, &positions, &solution.coefficients);
                    last = solution.coefficients;
                }
                ballot.take(problem, &sums, solution.rho);
            }
        }
        for (count, ballot) in counts.iter_mut().zip(&ballots) {
            let is_right = |(winner, row): (usize, &usize)| {
                fold.training[winner].0 == self.data.targets[self.sorted.order()[*row]]
            };
            let winners = ballot.winners().into_iter();
            *count += winners
                .zip(&fold.validation)
                .filter(|&pair| is_right(pair))
                .count();
        }
        n_capped
    }
}

/// `Σ β_i row_i` over the rows at these positions.
fn weighted_sum<T: Scalar>(sums: &mut [T], rows: &Array2<T>, positions: &[usize], beta: &[f64]) {
    sums.fill(T::zero());
    let rows = |at: usize| {
        rows.row(at)
            .to_slice()
            .expect("rows were gathered one by one")
    };
    let support = positions.iter().zip(beta).filter(|(_, beta)| **beta != 0.0);
    let support: Vec<(&[T], T)> = support
        .map(|(&at, &beta)| (rows(at), T::of(beta)))
        .collect();
    let (fours, rest) = support.as_chunks::<4>();
    for four in fours {
        add_four(sums, four);
    }
    for &(row, beta) in rest {
        add_four(
            sums,
            &[
                (row, beta),
                (row, T::zero()),
                (row, T::zero()),
                (row, T::zero()),
            ],
        );
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

/// Rows and columns of a larger matrix; columns that follow each other are copied at once.
fn gather<T: Scalar>(whole: ArrayView2<T>, rows: &[usize], columns: &[usize]) -> Array2<T> {
    let mut part = Array2::zeros((rows.len(), columns.len()));
    let runs: Vec<&[usize]> = columns.chunk_by(|a, b| a + 1 == *b).collect();
    for (&row, mut to) in rows.iter().zip(part.rows_mut()) {
        let from = whole
            .row(row)
            .to_slice()
            .expect("a product is stored row by row");
        let mut to = to.as_slice_mut().expect("a new array is contiguous");
        for run in &runs {
            let (now, later) = to.split_at_mut(run.len());
            now.copy_from_slice(&from[run[0]..run[0] + run.len()]);
            to = later;
        }
    }
    part
}
