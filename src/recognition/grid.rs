//! Cross-validation of a whole grid of C and kernels on one matrix of products.
//!
//! All folds and all candidates are parts of the same n × n products: a kernel is made of them once, each fold's problems
//! are gathered from that, and along C each solution starts from the last. Validation rows meet all problems of a class
//! and all C in one matrix product.

use ndarray::{Array2, Array3, ArrayView2, Axis, s};

use crate::recognition::dataset::Dataset;
use crate::recognition::kernel::KernelFunction;
use crate::recognition::scalar::Scalar;
use crate::recognition::smo::{Dense, Smo};
use crate::recognition::split::Split;
use crate::recognition::svm::Multiclass;
use crate::recognition::training::{Goal, Sorted};
use crate::recognition::voting::Voting;

/// Training rows and their division into folds.
pub(crate) struct Grid<'a, T> {
    /// The rows, by class.
    pub sorted: &'a Sorted<T>,
    pub data: &'a Dataset,
    pub folds: &'a [Split],
    pub multiclass: Multiclass,
}

/// A fold in terms of sorted rows.
struct Fold {
    /// Training rows of each class that has any, with the class.
    training: Vec<(usize, Vec<usize>)>,
    validation: Vec<usize>,
}

/// A binary problem of a fold: classes by their position in [`Fold::training`].
struct Problem {
    positive: usize,
    negative: Option<usize>,
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
                let (correct, capped) = self.evaluate(fold, values.view(), goal);
                counts
                    .iter_mut()
                    .zip(correct)
                    .for_each(|(sum, n)| *sum += n);
                n_capped += capped;
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

    /// Validation rows recognised per C, and solves stopped at the cap.
    fn evaluate(&self, fold: &Fold, kernel: ArrayView2<T>, goal: Goal) -> (Vec<usize>, usize) {
        let problems = self.problems(fold.training.len());
        let n_path = goal.path.len();
        // Coefficients by class: rows × (problems of the class × C), and where a problem stands among its class's.
        let mut coefficients: Vec<Array2<T>> = Vec::new();
        let mut columns: Vec<Vec<usize>> = vec![Vec::new(); fold.training.len()];
        for (index, problem) in problems.iter().enumerate() {
            for (class, columns) in columns.iter_mut().enumerate() {
                if problem.takes(class) {
                    columns.push(index);
                }
            }
        }
        for ((_, rows), columns) in fold.training.iter().zip(&columns) {
            coefficients.push(Array2::zeros((rows.len(), columns.len() * n_path)));
        }
        let mut filled = vec![0; fold.training.len()];
        let mut rho = Array2::<f64>::zeros((n_path, problems.len()));
        let mut n_capped = 0;
        let mut gram = Dense::default();
        for (index, problem) in problems.iter().enumerate() {
            let classes: Vec<usize> = (0..fold.training.len())
                .filter(|&c| problem.takes(c))
                .collect();
            let rows: Vec<usize> = classes
                .iter()
                .flat_map(|&c| fold.training[c].1.clone())
                .collect();
            let is_positive: Vec<bool> = classes
                .iter()
                .flat_map(|&c| std::iter::repeat_n(c == problem.positive, fold.training[c].1.len()))
                .collect();
            gram.of_rows(kernel, &rows);
            let mut smo = Smo::new(&mut gram, &is_positive);
            for (at, &c) in goal.path.iter().enumerate() {
                let solution = smo.solve(c, goal.tolerance);
                n_capped += usize::from(solution.is_capped);
                rho[[at, index]] = solution.rho;
                let mut from = solution.coefficients.iter();
                for &class in &classes {
                    let column = filled[class] * n_path + at;
                    for to in coefficients[class].column_mut(column) {
                        *to = from.next().map_or(T::zero(), |&beta| T::of(beta));
                    }
                }
            }
            classes.iter().for_each(|&class| filled[class] += 1);
        }
        let mut sums = Array3::<T>::zeros((n_path, fold.validation.len(), problems.len()));
        for (((_, rows), columns), coefficients) in
            fold.training.iter().zip(&columns).zip(&coefficients)
        {
            let part = gather(kernel, &fold.validation, rows).dot(coefficients);
            for (row, values) in part.rows().into_iter().enumerate() {
                for (chunk, &problem) in values.exact_chunks(n_path).into_iter().zip(columns) {
                    for (at, &value) in chunk.iter().enumerate() {
                        sums[[at, row, problem]] += value;
                    }
                }
            }
        }
        let classes: Vec<usize> = fold.training.iter().map(|&(class, _)| class).collect();
        let sides = problems
            .iter()
            .map(|p| (classes[p.positive], p.negative.map(|class| classes[class])));
        let voting = Voting::new(&classes, self.multiclass, sides);
        let truth: Vec<usize> = fold
            .validation
            .iter()
            .map(|&row| self.data.targets[self.sorted.order()[row]])
            .collect();
        let correct = sums.axis_iter(Axis(0)).zip(rho.rows()).map(|(sums, rho)| {
            let values = sums.mapv(T::wide) - rho;
            let labels = voting.labels(values.view());
            labels.iter().zip(&truth).filter(|(a, b)| a == b).count()
        });
        (correct.collect(), n_capped)
    }

    fn problems(&self, n_classes: usize) -> Vec<Problem> {
        match self.multiclass {
            Multiclass::OneVsRest => (0..n_classes)
                .map(|positive| Problem {
                    positive,
                    negative: None,
                })
                .collect(),
            _ => (0..n_classes)
                .flat_map(|positive| {
                    (positive + 1..n_classes).map(move |negative| Problem {
                        positive,
                        negative: Some(negative),
                    })
                })
                .collect(),
        }
    }
}

impl Problem {
    /// Whether the class has rows in it.
    fn takes(&self, class: usize) -> bool {
        self.negative
            .is_none_or(|negative| class == negative || class == self.positive)
    }
}

/// Rows and columns of a larger matrix.
fn gather<T: Scalar>(whole: ArrayView2<T>, rows: &[usize], columns: &[usize]) -> Array2<T> {
    let mut part = Array2::zeros((rows.len(), columns.len()));
    for (&row, mut to) in rows.iter().zip(part.rows_mut()) {
        let from = whole.slice(s![row, ..]);
        for (to, &column) in to.iter_mut().zip(columns) {
            *to = from[column];
        }
    }
    part
}
