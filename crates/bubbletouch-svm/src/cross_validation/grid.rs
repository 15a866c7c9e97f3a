//! Cross-validation of a whole grid of C values and kernels that share one matrix of inner products.
//!
//! All folds and candidates share the products of rows. The kernel values of a pair of classes are computed once for all folds (`fold_path`). For each C, the
//! solver starts from the solution of the previous C. For the first C, a pair starts with all multipliers at their bounds, or from the previous fold
//! (`alpha_seeding`) if that start is closer. Validation rows are scored by the problems of their own class first (`validation_scorer`).

use std::ops::Range;

use ndarray::{Array1, Array2, Array3};

use super::validation_scorer::ValidationScorer;
use crate::class_weight::ClassWeight;
use crate::cross_validation::fold_path::FoldPath;
use crate::gram::matrix::{Gram, GramMemory};
use crate::gram::pairs::{Block, gram_of_pair};
use crate::gram::sorted::Sorted;
use crate::kernel::KernelFunction;
use crate::linalg::products::own_products;
use crate::multiclass::Multiclass;
use crate::smo::SolverScalar;
use crate::split::Split;
use crate::training::Goal;

/// Maximum number of folds whose solutions are kept in memory at the same time. With a larger value, more memory is used; with a smaller value, five or ten
/// folds need several passes.
const FOLDS_AT_ONCE: usize = 8;

/// Number of classes per block of the kernel matrix in one-vs-one cross-validation. The pairs between two blocks of classes are solved together and share
/// kernel values (5 MB for 140 rows per class).
const CLASSES_AT_ONCE: usize = 8;

/// Data of a cross-validated grid search over kernels and C: training rows, folds and multi-class strategy.
pub(crate) struct Grid<'a, T> {
    /// Training rows, sorted by class label.
    pub sorted: &'a Sorted<T>,
    /// Training and validation rows of each fold, by original row number.
    pub folds: &'a [Split],
    /// Multi-class strategy: one-vs-one or one-vs-rest.
    pub multiclass: Multiclass,
    /// Weights of the classes among the training rows of a fold.
    pub class_weight: ClassWeight,
}

/// Cross-validation fold, given by row positions in the sorted order.
struct Fold {
    /// Number of times that each row, in sorted order, is a training row of the fold. A repeated row has a multiple of the penalty C.
    n_times: Vec<usize>,
    /// Whether the fold has at least one training row of each class.
    is_class: Vec<bool>,
    /// Weight of each class in training.
    weights: Array1<f64>,
    validation: Vec<usize>,
}

impl<T: SolverScalar> Grid<'_, T> {
    /// Returns the number of correctly classified validation rows for each kernel, C and fold (kernels.len() × path.len() × folds.len()). Also returns the number
    /// of solver runs that stopped at the iteration cap.
    pub fn n_correct(&self, kernels: &[KernelFunction], goal: Goal) -> (Array3<usize>, usize) {
        let points = self.sorted.points.all();
        // The kernels differ only in γ, so they share the products of rows.
        let products = own_products(points.values);
        let folds: Vec<Fold> = self.folds.iter().map(|split| self.fold(split)).collect();
        let mut counts = Array3::zeros((kernels.len(), goal.path.len(), folds.len()));
        let mut n_capped = 0;
        for (&kernel, mut counts) in kernels.iter().zip(counts.outer_iter_mut()) {
            let mut values = products.clone();
            points.apply(values.view_mut(), points, &kernel);
            let mut counts = counts.columns_mut().into_iter();
            for folds in folds.chunks(FOLDS_AT_ONCE) {
                let scorers = self.score(folds, &values, goal);
                for (scorer, mut counts) in scorers.iter().zip(&mut counts) {
                    n_capped += scorer.n_capped();
                    counts.assign(&Array1::from(scorer.n_correct(values.view())));
                }
            }
        }
        (counts, n_capped)
    }

    fn fold(&self, split: &Split) -> Fold {
        let place = &self.sorted.place;
        let mut n_times = vec![0; place.len()];
        split.train.iter().for_each(|&row| n_times[place[row]] += 1);
        let ranges = self.sorted.ranges.iter();
        let mut validation: Vec<usize> = split.test.iter().map(|&row| place[row]).collect();
        validation.sort_unstable();
        let n_training = |range: &Range<usize>| n_times[range.clone()].iter().sum();
        let sizes: Vec<usize> = ranges.map(n_training).collect();
        Fold {
            is_class: sizes.iter().map(|&n| n > 0).collect(),
            weights: self.class_weight.of_sizes(sizes),
            n_times,
            validation,
        }
    }

    /// Solves all binary problems of some folds and counts their correctly classified validation rows, given the kernel values of all rows.
    fn score(&self, folds: &[Fold], values: &Array2<T>, goal: Goal) -> Vec<ValidationScorer<T>> {
        let scorer = |fold| self.scorer(fold, goal.path.len());
        let mut scorers: Vec<ValidationScorer<T>> = folds.iter().map(scorer).collect();
        let (mut above, mut memory) = (Vec::new(), GramMemory::default());
        let is_rest = self.multiclass == Multiclass::OneVsRest;
        let mut whole = is_rest.then(|| Gram::whole(values.view()));
        for (number, problem) in self.problems() {
            let takes_part = |fold: &Fold, class: usize| fold.is_class[class];
            let both = folds.iter().zip(&mut scorers).filter(|(fold, _)| {
                takes_part(fold, problem.0) && problem.1.is_none_or(|class| takes_part(fold, class))
            });
            let (folds, scorers): (Vec<&Fold>, Vec<_>) = both.unzip();
            let limits = self.limits(problem, &folds);
            let mut scorers = scorers.into_iter();
            let score = |path: &FoldPath| {
                let scorer = scorers.next().expect("each fold has one");
                path.solutions
                    .iter()
                    .for_each(|solution| scorer.take(number, solution));
            };
            if let Some(gram) = &mut whole {
                FoldPath::of_class(gram, limits, goal, score);
            } else if let (first, Some(second)) = problem {
                let classes = [first, second].map(|class| &self.sorted.ranges[class]);
                let blocks = [Block::new(values, [0, 0]); 3];
                let mut gram = gram_of_pair(classes, blocks, &mut above, memory);
                let positive = 0..classes[0].len();
                FoldPath::of_pair(&mut gram, (limits, &positive), goal, score);
                memory = gram.into_memory();
            }
        }
        scorers
    }

    fn scorer(&self, fold: &Fold, n_path: usize) -> ValidationScorer<T> {
        let ranges = &self.sorted.ranges;
        let of_class = |row: &usize| ranges.partition_point(|range| range.end <= *row);
        let rows = fold.validation.iter().map(|row| (*row, of_class(row)));
        let known = rows.filter(|(_, class)| fold.is_class[*class]).collect();
        ValidationScorer::new((known, &fold.is_class), ranges, self.multiclass, n_path)
    }

    /// Returns the number and the classes of every binary problem, in an order in which neighbouring problems share cached kernel values.
    fn problems(&self) -> Vec<(usize, (usize, Option<usize>))> {
        let problems = self.multiclass.problems(self.sorted.ranges.len());
        let mut problems: Vec<_> = problems.into_iter().enumerate().collect();
        let group = |class: usize| class / CLASSES_AT_ONCE;
        problems.sort_by_key(|&(_, (a, b))| (group(a), b.map(group)));
        problems
    }

    /// Returns the limits of the coefficients of a binary problem's rows for each fold: the label of a row times the weight of its class, or 0 if it is held out.
    fn limits(
        &self,
        (positive, negative): (usize, Option<usize>),
        folds: &[&Fold],
    ) -> Vec<Vec<f64>> {
        let ranges = &self.sorted.ranges;
        let classes = match negative {
            Some(negative) => vec![positive, negative],
            None => (0..ranges.len()).collect(),
        };
        let of_fold = |fold: &&Fold| {
            let rows = classes.iter().flat_map(|&class| {
                let sign = if class == positive { 1.0 } else { -1.0 };
                let limit = sign * fold.weights[class];
                let rows = fold.n_times[ranges[class].clone()].iter();
                rows.map(move |&n| if n > 0 { limit * n as f64 } else { 0.0 })
            });
            rows.collect()
        };
        folds.iter().map(of_fold).collect()
    }
}
