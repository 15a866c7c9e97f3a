//! Cross-validation of a whole grid of C and kernels on one matrix of products.
//!
//! All folds and all candidates are parts of the same n × n products: a kernel is made of them once, and a pair's part of
//! it is brought together once for all folds. Along C each solution starts from the last, that of a pair at the first C from
//! all multipliers at their bounds and, from the second fold on, [from that of the fold before](crate::recognition::seed) where that is nearer. Validation rows are
//! [judged](crate::recognition::judgement) by their own class's problems first.

use std::ops::Range;
use std::rc::Rc;

use ndarray::{Array2, ArrayView2, s};

use crate::recognition::judgement::{Judgement, Solved};
use crate::recognition::kernel::KernelFunction;
use crate::recognition::scalar::Scalar;
use crate::recognition::seed::moved;
use crate::recognition::smo::{Room, Runs, Smo, part_of};
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

/// A binary problem's part of the kernel, of all folds' rows.
struct Block<'a, T> {
    /// The positive class, and the negative one (`None`: all others), by position.
    problem: (usize, Option<usize>),
    /// The sorted rows.
    rows: Vec<usize>,
    /// Which of them are positive.
    positive: Range<usize>,
    /// Their kernel values.
    kernel: ArrayView2<'a, T>,
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
        let mut values = Array2::zeros(products.dim());
        let mut columns = Vec::new();
        for (kernel, mut counts) in kernels.iter().zip(counts.rows_mut()) {
            // Class by class, so that rows are still in the cache.
            for range in self.sorted.ranges() {
                let mut values = values.slice_mut(s![range.clone(), ..]);
                values.assign(&products.slice(s![range.clone(), ..]));
                let own = self.sorted.points().range(range.clone());
                own.apply(values, all, kernel);
            }
            for folds in folds.chunks(FOLDS_AT_ONCE) {
                for judgement in self.judge(folds, values.view(), goal) {
                    n_capped += judgement.n_capped();
                    for (count, n_right) in counts.iter_mut().zip(judgement.n_right(
                        values.view(),
                        goal.path,
                        &mut columns,
                    )) {
                        *count += n_right;
                    }
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
    fn judge<'f>(
        &'f self,
        folds: &'f [Fold],
        kernel: ArrayView2<T>,
        goal: Goal,
    ) -> Vec<Judgement<'f>> {
        let ranges = self.sorted.ranges();
        let judgement = |fold: &'f Fold| {
            let of_class = |row: &usize| ranges.partition_point(|range| range.end <= *row);
            let rows = fold.validation.iter().map(|row| (*row, of_class(row)));
            let known = rows.filter(|(_, class)| fold.is_class[*class]).collect();
            Judgement::new(
                known,
                ranges,
                &fold.is_training,
                self.multiclass,
                goal.path.len(),
            )
        };
        let mut judgements: Vec<Judgement<'_>> = folds.iter().map(judgement).collect();
        let mut room = Room::new();
        let mut values = Vec::new();
        for problem in self.problems() {
            let block = self.block(problem, kernel.reborrow(), &mut values);
            // The fold before, and its solutions.
            let mut last: Option<(&Fold, Vec<Rc<[f64]>>)> = None;
            for (fold, judgement) in folds.iter().zip(&mut judgements) {
                let (positive, negative) = problem;
                let takes_part = |class: usize| fold.is_class[class];
                if !takes_part(positive) || !negative.is_none_or(takes_part) {
                    continue;
                }
                let (path, solutions) = solve(&block, fold, last.as_ref(), goal, &mut room);
                judgement.take(block.problem, &block.rows, block.kernel, path);
                last = Some((fold, solutions));
            }
        }
        judgements
    }

    /// All problems; pairs of neighbouring classes come together, so that their part of the kernel stays in the cache.
    fn problems(&self) -> Vec<(usize, Option<usize>)> {
        let mut problems = self.multiclass.problems(self.sorted.ranges().len());
        let group = |class: usize| class / CLASSES_AT_ONCE;
        problems.sort_by_key(|&(a, b)| (group(a), b.map(group)));
        problems
    }

    /// The rows of a problem, and their part of the kernel; `values` is room for it.
    fn block<'v>(
        &self,
        problem: (usize, Option<usize>),
        kernel: ArrayView2<'v, T>,
        values: &'v mut Vec<T>,
    ) -> Block<'v, T> {
        let own = self.sorted.ranges()[problem.0].clone();
        let Some(negative) = problem.1 else {
            return Block {
                problem,
                rows: (0..kernel.nrows()).collect(),
                positive: own,
                kernel,
            };
        };
        let rows = self.sorted.pair_rows(problem.0, negative);
        Block {
            problem,
            positive: 0..own.len(),
            kernel: gather_square(kernel, &rows, values),
            rows,
        }
    }
}

/// Solves a fold's problem for every C: what is needed of the solutions, and β of all rows of the block (0 where a row is not
/// trained on).
fn solve<T: Scalar>(
    block: &Block<T>,
    fold: &Fold,
    last: Option<&(&Fold, Vec<Rc<[f64]>>)>,
    goal: Goal,
    room: &mut Room<T>,
) -> (Vec<Solved>, Vec<Rc<[f64]>>) {
    let places: Vec<usize> = (0..block.rows.len())
        .filter(|&at| fold.is_training[block.rows[at]])
        .collect();
    let is_positive: Vec<bool> = places
        .iter()
        .map(|at| block.positive.contains(at))
        .collect();
    let mut gram = part_of(&block.kernel, &places, room);
    let mut smo = Smo::new(&mut gram, &is_positive);
    // Classes that no hyperplane parts from the rest have values that are equal within the tolerance, and the largest wins:
    // there the start decides. So one-vs-rest starts from nothing, as training does.
    let is_pair = block.problem.1.is_some();
    if is_pair && last.is_none() {
        smo = smo.at_bounds(goal.path[0]);
    }
    let mut path: Vec<Solved> = Vec::new();
    let mut solutions: Vec<Rc<[f64]>> = Vec::new();
    for (number, &c) in goal.path.iter().enumerate() {
        let seed = || {
            let (before, solutions) = last.filter(|_| is_pair)?;
            let is_training = |at: usize| fold.is_training[block.rows[at]];
            let was_training = |at: usize| before.is_training[block.rows[at]];
            let seed = moved(
                &solutions[number],
                (was_training, is_training),
                &block.positive,
                block.kernel,
            )?;
            Some(places.iter().map(|&at| seed[at]).collect())
        };
        let solution = smo.solve_or_from(c, goal.tolerance, seed);
        let mut beta = vec![0.0; block.rows.len()];
        for (&at, &value) in places.iter().zip(&solution.coefficients) {
            beta[at] = value;
        }
        let beta: Rc<[f64]> = beta.into();
        let is_new = solutions.last() != Some(&beta);
        path.push(Solved {
            beta: is_new.then(|| Rc::clone(&beta)),
            rho: solution.rho,
            is_capped: solution.is_capped,
        });
        solutions.push(beta);
    }
    (path, solutions)
}

/// The same rows and columns of a larger matrix, written into `to`.
fn gather_square<'v, T: Scalar>(
    whole: ArrayView2<T>,
    rows: &[usize],
    to: &'v mut Vec<T>,
) -> ArrayView2<'v, T> {
    let n = rows.len();
    to.resize(n * n, T::zero());
    let runs = Runs::new(rows);
    for (&row, to) in rows.iter().zip(to.chunks_exact_mut(n.max(1))) {
        let from = whole.row(row).to_slice();
        runs.copy(from.expect("a kernel is stored row by row"), to);
    }
    ArrayView2::from_shape((n, n), to).expect("rows fill the values")
}
