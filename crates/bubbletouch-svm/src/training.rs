//! Training of many binary problems on one set of rows, with common quantities computed only once.
//!
//! The rows are sorted by class. One-vs-one needs each block of kernel values between two classes once, and each block within a class for all its pairs.
//! The blocks within classes are stored. Only the requested rows of other blocks are read. For n rows of k classes, about n²/k values are in memory, not
//! n². One-vs-rest uses the whole matrix. For each problem, all values of C are solved while its Gram matrix is in memory; each solution starts from the
//! previous C.

use std::ops::Range;

use ndarray::Array2;

use crate::binary_problem::BinaryProblem;
use crate::dual::DualSolution;
use crate::gram::matrix::{Gram, GramMemory};
use crate::gram::pairs::{Block, bytes_of_groups, gram_of_pair, groups};
use crate::gram::sorted::{Sorted, pairs};
use crate::kernel::KernelFunction;
use crate::multiclass::Multiclass;
use crate::screening::first_rows::{PairsNearMargin, few_dimensions};
use crate::screening::near_margin::NearMargin;
use crate::smo::{Smo, SolverScalar};

/// Minimum number of features for screening, which trains each one-vs-one linear SVM only on rows near its decision boundary.
const SCREENING_FROM_FEATURES: usize = 128;
/// Minimum mean number of rows per class for screening, that is, training on the rows near the decision boundary.
const SCREENING_FROM_ROWS: usize = 64;

/// Solved binary problems of all classes for one value of C.
pub(crate) struct Trained<T> {
    pub problems: Vec<BinaryProblem>,
    /// Normals of the decision hyperplanes for centred rows (n_problems × m); `None` if the solver did not compute them.
    pub normals: Option<Array2<T>>,
}

/// Inputs of training other than the rows: penalties C, tolerance and memory limit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal<'a> {
    /// Penalties C in the order in which they are solved; each solution starts from the previous solution.
    pub path: &'a [f64],
    /// Largest allowed violation of the optimality conditions, in units of the decision value.
    pub tolerance: f64,
    /// Maximum size of the kernel values in memory at one time, bytes.
    pub memory: usize,
}

/// Sizes of a training set, which determine the kernel values that training stores.
pub(crate) struct KernelStorage<'a> {
    pub multiclass: Multiclass,
    pub is_linear: bool,
    pub n_features: usize,
    pub has_row_weights: bool,
    /// Range of each class's rows, sorted by class.
    pub ranges: &'a [Range<usize>],
}

/// Kernel values that training stores at one time, with their size in bytes.
pub(crate) enum Stored {
    /// Values of rows near the decision boundaries.
    NearMargin(usize),
    /// All values of each group of classes, or of all rows.
    Whole(usize),
    /// Values of the most recent rows, within the memory limit.
    Rows,
}

impl KernelStorage<'_> {
    /// Returns the kernel values that training stores within a memory limit, bytes. Screening (training on the rows near the decision boundaries) is used if it
    /// is faster than computing the inner products of all rows.
    pub fn within<T: SolverScalar>(&self, memory: usize) -> Stored {
        let n_rows = self.ranges.last().map_or(0, |last| last.end);
        let whole = match self.multiclass {
            Multiclass::OneVsOne => {
                let is_worth_screening = self.is_linear
                    && !self.has_row_weights
                    && self.n_features >= SCREENING_FROM_FEATURES
                    && n_rows >= SCREENING_FROM_ROWS * self.ranges.len();
                let most = NearMargin::<T>::most_bytes(self.ranges, self.n_features);
                if is_worth_screening && most <= memory {
                    return Stored::NearMargin(most);
                }
                let largest = self.ranges.iter().map(Range::len).max().unwrap_or(0);
                bytes_of_groups::<T>(self.ranges) + Gram::<T>::bytes(2 * largest)
            }
            // Two copies are in memory: the matrix product, and the padded matrix of the solver.
            Multiclass::OneVsRest => 2 * Gram::<T>::bytes(n_rows),
        };
        match whole <= memory {
            true => Stored::Whole(whole),
            false => Stored::Rows,
        }
    }
}

/// Classes of a binary problem: the positive class, and the negative class or `None` for all other classes.
type Sides = (usize, Option<usize>);

impl<T: SolverScalar> Sorted<T> {
    /// Solves the binary problems of all classes. Returns, for each C of the path, the problems in the order of their classes.
    pub fn solve_all(&self, multiclass: Multiclass, goal: Goal) -> Vec<Trained<T>> {
        let storage = KernelStorage {
            multiclass,
            is_linear: self.kernel == KernelFunction::Linear,
            n_features: self.centre.len(),
            has_row_weights: self.has_row_weights(),
            ranges: &self.ranges,
        };
        let mut problems = vec![Vec::new(); goal.path.len()];
        let normals = match (multiclass, storage.within::<T>(goal.memory)) {
            (Multiclass::OneVsOne, Stored::NearMargin(_)) => {
                Some(self.pairs_near_margin(goal, &mut problems))
            }
            (Multiclass::OneVsOne, Stored::Whole(_)) => {
                self.pairs_from_blocks(goal, &mut problems);
                None
            }
            (Multiclass::OneVsOne, Stored::Rows) => {
                for (a, b) in self.all_pairs() {
                    let points = self.points.select(&self.pair_rows(a, b));
                    let mut gram = Gram::of_points(&points, self.kernel, goal.memory);
                    self.solve(&mut gram, (a, Some(b)), goal, &mut problems);
                }
                None
            }
            (Multiclass::OneVsRest, stored) => {
                let mut gram = match stored {
                    Stored::Rows => Gram::of_points(&self.points, self.kernel, goal.memory),
                    _ => Gram::whole(self.points.all().own_kernel(&self.kernel).view()),
                };
                for class in 0..self.ranges.len() {
                    self.solve(&mut gram, (class, None), goal, &mut problems);
                }
                None
            }
        };
        for problems in &mut problems {
            problems.sort_by_key(|problem| (problem.positive, problem.negative));
        }
        let mut normals = normals.map(Vec::into_iter);
        let trained = problems.into_iter().map(|problems| Trained {
            problems,
            normals: normals.as_mut().and_then(Iterator::next),
        });
        trained.collect()
    }

    /// Solves the problems of all pairs on the rows near their decision boundaries. Returns the normals of the hyperplanes for each C.
    fn pairs_near_margin(&self, goal: Goal, problems: &mut [Vec<BinaryProblem>]) -> Vec<Array2<T>> {
        let few = few_dimensions(self);
        let all = PairsNearMargin::new(self, &few);
        let n_classes = self.ranges.len();
        let shape = (n_classes * (n_classes - 1) / 2, self.centre.len());
        let mut normals = vec![Array2::zeros(shape); goal.path.len()];
        for pairs in all.blocks() {
            let mut near_margin = all.near(&pairs, goal.path[0]);
            for (at, &c) in goal.path.iter().enumerate() {
                let solutions = near_margin.solve(c, goal.tolerance);
                for (&(a, b), (solution, normal)) in pairs.iter().zip(solutions) {
                    problems[at].push(self.problem(&self.pair_rows(a, b), (a, Some(b)), solution));
                    // The number of pairs of the preceding classes, plus the pairs of the first class with preceding others.
                    let number = a * (2 * n_classes - a - 1) / 2 + (b - a - 1);
                    let to = normals[at].row_mut(number).into_slice();
                    to.expect("normals are stored one by one")
                        .copy_from_slice(&normal);
                }
            }
        }
        normals
    }

    /// Solves the problems of all pairs on blocks of kernel values, which are computed for groups of classes.
    fn pairs_from_blocks(&self, goal: Goal, problems: &mut [Vec<BinaryProblem>]) {
        let groups = groups(&self.ranges);
        let points = |group: &Range<usize>| self.points.range(self.rows_of(group));
        let own = groups
            .iter()
            .map(|group| points(group).own_kernel(&self.kernel));
        let own: Vec<Array2<T>> = own.collect();
        let (mut above, mut memory) = (Vec::new(), GramMemory::default());
        for (at, group) in groups.iter().enumerate() {
            for (number, other) in groups.iter().enumerate().skip(at) {
                let computed;
                let between = match number == at {
                    true => &own[at],
                    false => {
                        computed = points(other).kernel(points(group), &self.kernel);
                        &computed
                    }
                };
                let starts = [group, other].map(|group| self.rows_of(group).start);
                for (a, b) in pairs(group.clone(), other.clone()) {
                    let blocks = [
                        Block::new(&own[at], [starts[0], starts[0]]),
                        Block::new(&own[number], [starts[1], starts[1]]),
                        Block::new(between, [starts[1], starts[0]]),
                    ];
                    let classes = [a, b].map(|class| &self.ranges[class]);
                    let mut gram = gram_of_pair(classes, blocks, &mut above, memory);
                    self.solve(&mut gram, (a, Some(b)), goal, problems);
                    memory = gram.into_memory();
                }
            }
        }
    }

    /// Solves one binary problem for each value of the penalty C, given its Gram matrix.
    fn solve(
        &self,
        gram: &mut Gram<T>,
        (positive, negative): Sides,
        goal: Goal,
        problems: &mut [Vec<BinaryProblem>],
    ) {
        let rows = match negative {
            Some(negative) => self.pair_rows(positive, negative),
            None => (0..self.order.len()).collect(),
        };
        let is_positive = |row: &usize| self.ranges[positive].contains(row);
        let limit = |row: &usize| match is_positive(row) {
            true => self.weights[*row],
            false => -self.weights[*row],
        };
        let limits: Vec<f64> = rows.iter().map(limit).collect();
        let mut smo = Smo::new(gram, &limits);
        for (&c, problems) in goal.path.iter().zip(problems) {
            let solution = smo.solve(c, goal.tolerance);
            problems.push(self.problem(&rows, (positive, negative), solution));
        }
    }

    /// Creates a binary problem on the given sorted rows with its solution, and converts the solution's offset from centred rows to original rows.
    fn problem(
        &self,
        rows: &[usize],
        (positive, negative): Sides,
        mut solution: DualSolution,
    ) -> BinaryProblem {
        solution.rho += self.moved(rows.iter().copied(), &solution.coefficients);
        let mut rows: Vec<usize> = rows.iter().map(|&row| self.order[row]).collect();
        if negative.is_none() {
            // All problems of one class against the rest have the order of the training rows.
            let in_order = self.place.iter().map(|&at| solution.coefficients[at]);
            solution.coefficients = in_order.collect();
            rows = (0..rows.len()).collect();
        }
        BinaryProblem {
            positive,
            negative,
            rows,
            solution,
        }
    }
}
