//! Cross-validation of a whole grid of C and kernels on one matrix of products.
//!
//! All folds and all candidates are parts of the same n × n products: a kernel is made of them once, each fold's problems
//! are gathered from that, and along C each solution starts from the last. Validation rows meet all problems of a class
//! and all C in one matrix product.

use ndarray::{Array2, ArrayView2, s};

use crate::recognition::dataset::Dataset;
use crate::recognition::kernel::KernelFunction;
use crate::recognition::scalar::Scalar;
use crate::recognition::smo::{Part, Room, Smo};
use crate::recognition::split::Split;
use crate::recognition::svm::Multiclass;
use crate::recognition::training::{Goal, Sorted};
use crate::recognition::voting::Voting;

/// Validation rows whose decision values are summed at once: with 43 classes and six C they take 1.4 MB. Larger leaves the
/// processor's cache, smaller makes the products inefficient.
const BLOCK_ROWS: usize = 64;

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

/// What a class's training rows weigh in the problems that it takes part in, for every C.
struct Weights<T> {
    /// rows × (C × problems of the class).
    coefficients: Array2<T>,
    /// Its problems, ascending.
    problems: Vec<usize>,
}

/// All problems of a fold, solved.
struct Solved<T> {
    weights: Vec<Weights<T>>,
    /// n_path × n_problems.
    rho: Array2<f64>,
    n_capped: usize,
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
            all.apply(&mut values, all, kernel);
            for fold in &folds {
                let solved = self.solve(fold, values.view(), goal);
                let correct = self.validate(fold, values.view(), &solved);
                counts
                    .iter_mut()
                    .zip(correct)
                    .for_each(|(sum, n)| *sum += n);
                n_capped += solved.n_capped;
            }
        }
        (counts, n_capped)
    }

    fn fold(&self, split: &Split) -> Fold {
        let mut place = vec![0; self.data.targets.len()];
        for (at, &row) in self.sorted.order().iter().enumerate() {
            place[row] = at;
        }
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
        Fold {
            training: training.collect(),
            validation: split.test.iter().map(|&row| place[row]).collect(),
        }
    }

    fn solve(&self, fold: &Fold, kernel: ArrayView2<T>, goal: Goal) -> Solved<T> {
        let problems = self.multiclass.problems(fold.training.len());
        let n_path = goal.path.len();
        let takes_part = |class: usize, &(positive, negative): &(usize, Option<usize>)| {
            negative.is_none_or(|negative| class == positive || class == negative)
        };
        let weights = fold.training.iter().enumerate().map(|(class, (_, rows))| {
            let own = (0..problems.len()).filter(|&at| takes_part(class, &problems[at]));
            let problems: Vec<usize> = own.collect();
            Weights {
                coefficients: Array2::zeros((rows.len(), problems.len() * n_path)),
                problems,
            }
        });
        let mut solved = Solved {
            weights: weights.collect(),
            rho: Array2::zeros((n_path, problems.len())),
            n_capped: 0,
        };
        let mut room = Room::new();
        for (index, problem) in problems.iter().enumerate() {
            let classes: Vec<usize> = (0..fold.training.len())
                .filter(|&class| takes_part(class, problem))
                .collect();
            let rows_of = |&class: &usize| fold.training[class].1.as_slice();
            let rows = classes.iter().map(rows_of).collect::<Vec<_>>().concat();
            let is_positive: Vec<bool> = classes
                .iter()
                .flat_map(|class| std::iter::repeat_n(*class == problem.0, rows_of(class).len()))
                .collect();
            let mut gram = Part::new(&kernel, &rows, &mut room);
            let mut smo = Smo::new(&mut gram, &is_positive);
            for (at, &c) in goal.path.iter().enumerate() {
                let solution = smo.solve(c, goal.tolerance);
                solved.n_capped += usize::from(solution.is_capped);
                solved.rho[[at, index]] = solution.rho;
                let mut from = solution.coefficients.iter();
                for &class in &classes {
                    solved.weights[class].take(index, at, &mut from);
                }
            }
        }
        solved
    }

    /// Validation rows recognised, per C.
    fn validate(&self, fold: &Fold, kernel: ArrayView2<T>, solved: &Solved<T>) -> Vec<usize> {
        let (n_path, n_problems) = solved.rho.dim();
        let classes: Vec<usize> = fold.training.iter().map(|&(class, _)| class).collect();
        let voting = Voting::new(&classes, self.multiclass);
        let mut n_correct = vec![0; n_path];
        let mut values = Vec::with_capacity(n_problems);
        let mut votes = Vec::new();
        for rows in fold.validation.chunks(BLOCK_ROWS) {
            let sums = solved.sums(fold, kernel, rows);
            for (&row, sums) in rows.iter().zip(sums.chunks_exact(n_path * n_problems)) {
                let truth = self.data.targets[self.sorted.order()[row]];
                let of_path = sums.chunks_exact(n_problems).zip(solved.rho.rows());
                for (n_correct, (sums, rho)) in n_correct.iter_mut().zip(of_path) {
                    values.clear();
                    values.extend(sums.iter().zip(rho).map(|(sum, rho)| sum.wide() - rho));
                    *n_correct += usize::from(voting.label(&values, &mut votes) == truth);
                }
            }
        }
        n_correct
    }
}

impl<T: Scalar> Solved<T> {
    /// Decision values before ρ: for each of these rows, C by C, those of all problems.
    fn sums(&self, fold: &Fold, kernel: ArrayView2<T>, rows: &[usize]) -> Vec<T> {
        let (n_path, n_problems) = self.rho.dim();
        let mut sums = vec![T::zero(); rows.len() * n_path * n_problems];
        for ((_, training), weights) in fold.training.iter().zip(&self.weights) {
            let part = gather(kernel, rows, training).dot(&weights.coefficients);
            let part = part.as_slice().expect("a product is stored row by row");
            let parts = part.chunks_exact(weights.problems.len());
            for (sums, part) in sums.chunks_exact_mut(n_problems).zip(parts) {
                for (&problem, &value) in weights.problems.iter().zip(part) {
                    sums[problem] += value;
                }
            }
        }
        sums
    }
}

impl<T: Scalar> Weights<T> {
    /// Takes the class's coefficients in a problem, for one C of the path, from those of all its rows.
    fn take<'a>(&mut self, problem: usize, at: usize, from: &mut impl Iterator<Item = &'a f64>) {
        let n_problems = self.problems.len();
        let column = at * n_problems + self.problems.partition_point(|&other| other < problem);
        for (to, &beta) in self.coefficients.column_mut(column).iter_mut().zip(from) {
            *to = T::of(beta);
        }
    }
}

/// Rows and columns of a larger matrix; columns that follow each other are copied at once.
fn gather<T: Scalar>(whole: ArrayView2<T>, rows: &[usize], columns: &[usize]) -> Array2<T> {
    let mut part = Array2::zeros((rows.len(), columns.len()));
    let runs: Vec<&[usize]> = columns.chunk_by(|a, b| a + 1 == *b).collect();
    for (&row, mut to) in rows.iter().zip(part.rows_mut()) {
        let mut start = 0;
        for run in &runs {
            let from = whole.slice(s![row, run[0]..run[0] + run.len()]);
            to.slice_mut(s![start..start + run.len()]).assign(&from);
            start += run.len();
        }
    }
    part
}
