//! Cross-validation of a whole grid of C and kernels on one matrix of products.
//!
//! All folds and all candidates are parts of the same n × n products: a kernel is made of them once, and a pair's part of
//! it is brought together once for all folds, which [leave rows out](crate::recognition::fold_path). Along C each solution
//! starts from the last, that of a pair at the first C from all multipliers at their bounds and, from the second fold on,
//! [from that of the fold before](crate::recognition::seed) where that is nearer. Validation rows are
//! [judged](crate::recognition::judgement) by their own class's problems first.

use ndarray::Array2;

use crate::recognition::class_columns::ClassColumns;
use crate::recognition::fold_path::FoldPath;
use crate::recognition::judgement::Judgement;
use crate::recognition::kernel::KernelFunction;
use crate::recognition::product_kernel::ProductKernel;
use crate::recognition::scalar::Scalar;
use crate::recognition::smo::Dense;
use crate::recognition::sorted::Sorted;
use crate::recognition::split::Split;
use crate::recognition::svm::Multiclass;
use crate::recognition::training::Goal;

/// Folds whose solutions are held at once: as many as are usual, so that many take no more memory.
const FOLDS_AT_ONCE: usize = 8;

/// Neighbouring classes whose pairs with as many others come together: of 140 rows each, kernel values of 5 MB.
const CLASSES_AT_ONCE: usize = 8;

/// Training rows and their division into folds.
pub(crate) struct Grid<'a, T> {
    /// The rows, by class.
    pub sorted: &'a Sorted<T>,
    /// How they are divided, by their own numbers; a row counts once in a fold.
    pub folds: &'a [Split],
    /// One-vs-one or one-vs-rest.
    pub multiclass: Multiclass,
}

/// A fold in terms of sorted rows.
struct Fold {
    /// Whether each row is trained on.
    is_training: Vec<bool>,
    /// Whether any row of each class is.
    is_class: Vec<bool>,
    validation: Vec<usize>,
}

impl<T: Scalar> Grid<'_, T> {
    /// Validation rows recognised, over all folds, per kernel and C (kernels.len() × path.len()), and solves stopped at the
    /// iteration cap.
    pub fn n_correct(&self, kernels: &[KernelFunction], goal: Goal) -> (Array2<usize>, usize) {
        let all = self.sorted.points().all();
        let products = all.packed().own_products();
        let folds: Vec<Fold> = self.folds.iter().map(|split| self.fold(split)).collect();
        let mut counts = Array2::zeros((kernels.len(), goal.path.len()));
        let mut n_capped = 0;
        let columns = ClassColumns::new(self.sorted.ranges());
        let (points, ranges) = (self.sorted.points(), self.sorted.ranges());
        let mut rooms = Vec::new();
        for (&kernel, mut counts) in kernels.iter().zip(counts.rows_mut()) {
            let kernel = ProductKernel::new(points, products.view(), kernel, ranges);
            for folds in folds.chunks(FOLDS_AT_ONCE) {
                rooms.resize(folds.len(), Vec::new());
                let share = folds.len() as f64 / (self.folds.len() * kernels.len()) as f64;
                let goal = Goal {
                    progress: goal.progress.part(share),
                    ..goal
                };
                let judgements = self.judge(folds, (&columns, &mut rooms), &kernel, goal);
                for (judgement, room) in judgements.into_iter().zip(&mut rooms) {
                    n_capped += judgement.n_capped();
                    let n_right = judgement.n_right(|row, to| kernel.write_row(row, to));
                    let both = counts.iter_mut().zip(n_right);
                    both.for_each(|(count, n_right)| *count += n_right);
                    *room = judgement.into_room();
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
        let ranges = self.sorted.ranges().iter();
        let mut validation: Vec<usize> = split.test.iter().map(|&row| place[row]).collect();
        validation.sort_unstable();
        Fold {
            is_class: ranges
                .map(|range| is_training[range.clone()].contains(&true))
                .collect(),
            is_training,
            validation,
        }
    }

    /// Solves all problems of some folds, and judges their validation rows.
    fn judge<'c>(
        &self,
        folds: &[Fold],
        (columns, rooms): (&'c ClassColumns, &mut [Vec<T>]),
        kernel: &ProductKernel<T>,
        goal: Goal,
    ) -> Vec<Judgement<'c, T>> {
        let folds_and_rooms = folds.iter().zip(rooms);
        let judgement = |(fold, room)| self.judgement(fold, (columns, room), goal);
        let mut judgements: Vec<Judgement<T>> = folds_and_rooms.map(judgement).collect();
        let (mut gram, mut between) = (Dense::default(), Vec::new());
        if self.multiclass == Multiclass::OneVsRest {
            kernel.write_all(&mut gram);
        }
        let problems = self.problems();
        for &problem in &problems {
            let rows = self.rows(problem);
            if let (positive, Some(negative)) = problem {
                kernel.write_pair((positive, negative), &mut between, &mut gram);
            }
            // The fold before.
            let mut last: Option<FoldPath> = None;
            for (fold, judgement) in folds.iter().zip(&mut judgements) {
                let takes_part = |class: usize| fold.is_class[class];
                if !takes_part(problem.0) || !problem.1.is_none_or(takes_part) {
                    continue;
                }
                let path = self.solve((problem, &rows), fold, last.as_ref(), goal, &mut gram);
                if let (positive, Some(negative)) = problem {
                    let [first, second] = [positive, negative].map(|at| &columns.ranges()[at]);
                    let place = |row: usize| match first.contains(&row) {
                        true => row - first.start,
                        false => first.len() + row - second.start,
                    };
                    for (number, solution) in path.solutions.iter().enumerate() {
                        let sum = |row: usize| -solution.f[place(row)];
                        judgement.look((positive, negative), number, (sum, solution.rho));
                    }
                }
                for (number, solution) in path.solutions.iter().enumerate() {
                    let is_last = number > 0 && path.solutions[number - 1].beta == solution.beta;
                    judgement.take(problem, solution, is_last);
                }
                last = Some(path);
            }
            goal.progress.done(1, problems.len());
        }
        judgements
    }

    fn judgement<'c>(
        &self,
        fold: &Fold,
        (columns, room): (&'c ClassColumns, &mut Vec<T>),
        goal: Goal,
    ) -> Judgement<'c, T> {
        let ranges = self.sorted.ranges();
        let of_class = |row: &usize| ranges.partition_point(|range| range.end <= *row);
        let rows = fold.validation.iter().map(|row| (*row, of_class(row)));
        let known = rows.filter(|(_, class)| fold.is_class[*class]).collect();
        let n_path = goal.path.len();
        let room = std::mem::take(room);
        let fold = (known, &fold.is_class[..]);
        Judgement::new(fold, (columns, room), self.multiclass, n_path)
    }

    /// All problems; pairs of neighbouring classes come together, so that their part of the kernel stays in the cache.
    fn problems(&self) -> Vec<(usize, Option<usize>)> {
        let mut problems = self.multiclass.problems(self.sorted.ranges().len());
        let group = |class: usize| class / CLASSES_AT_ONCE;
        problems.sort_by_key(|&(a, b)| (group(a), b.map(group)));
        problems
    }

    /// The rows of a problem, ascending.
    fn rows(&self, (positive, negative): (usize, Option<usize>)) -> Vec<usize> {
        match negative {
            Some(negative) => self.sorted.pair_rows(positive, negative),
            None => (0..self.sorted.points().len()).collect(),
        }
    }

    /// Solves a fold's problem for every C.
    fn solve(
        &self,
        (problem, rows): ((usize, Option<usize>), &[usize]),
        fold: &Fold,
        last: Option<&FoldPath>,
        goal: Goal,
        gram: &mut Dense<T>,
    ) -> FoldPath {
        let own = &self.sorted.ranges()[problem.0];
        let label = |row: &usize| match (fold.is_training[*row], own.contains(row)) {
            (false, _) => 0.0,
            (true, true) => 1.0,
            (true, false) => -1.0,
        };
        let labels: Vec<f64> = rows.iter().map(label).collect();
        match problem.1 {
            Some(_) => FoldPath::of_pair(gram, (labels, &(0..own.len())), last, goal),
            None => FoldPath::of_class(gram, labels, goal),
        }
    }
}
