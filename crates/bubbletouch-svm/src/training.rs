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
use crate::gram::between::{Group, groups};
use crate::gram::cached::Cached;
use crate::gram::matrix::{Dense, Gram};
use crate::gram::part::{Workspace, part_of_blocks};
use crate::gram::sorted::Sorted;
use crate::gram::sorted::pairs;
use crate::kernel::KernelFunction;
use crate::linalg::transposed::write_columns;
use crate::multiclass::Multiclass;
use crate::screening::first_rows::{PairsNearMargin, few_dimensions};
use crate::screening::near_margin::NearMargin;
use crate::smo::Smo;
use crate::smo::SolverScalar;

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
                Group::<T>::bytes(self.ranges) + Dense::<T>::bytes(2 * largest)
            }
            // Two copies are in memory: the matrix product, and the padded matrix of the solver.
            Multiclass::OneVsRest => 2 * Dense::<T>::bytes(n_rows),
        };
        match whole <= memory {
            true => Stored::Whole(whole),
            false => Stored::Rows,
        }
    }
}

impl<T: SolverScalar> Sorted<T> {
    fn storage(&self, multiclass: Multiclass) -> KernelStorage<'_> {
        KernelStorage {
            multiclass,
            is_linear: self.kernel() == KernelFunction::Linear,
            n_features: self.centre().len(),
            has_row_weights: self.has_row_weights(),
            ranges: self.ranges(),
        }
    }

    /// Solves the binary problem of every pair of classes. Returns, for each C of the path, the problems (0, 1), (0, 2), …, (1, 2), ….
    pub fn one_vs_one(&self, goal: Goal) -> Vec<Trained<T>> {
        let mut problems = vec![Vec::new(); goal.path.len()];
        match self.storage(Multiclass::OneVsOne).within::<T>(goal.memory) {
            Stored::NearMargin(_) => return self.pairs_near_margin(goal),
            Stored::Whole(_) => self.pairs_from_blocks(goal, &mut problems),
            Stored::Rows => self.pairs_from_rows(goal, &mut problems),
        }
        without_normals(problems)
    }

    fn pairs_near_margin(&self, goal: Goal) -> Vec<Trained<T>> {
        let few = few_dimensions(self);
        let all = PairsNearMargin::new(self, &few);
        let n_classes = self.classes().len();
        let mut problems = vec![Vec::new(); goal.path.len()];
        let shape = (n_classes * (n_classes - 1) / 2, self.centre().len());
        let mut normals = vec![Array2::zeros(shape); goal.path.len()];
        for pairs in all.blocks() {
            let mut near_margin = all.near(&pairs, goal.path[0]);
            for (at, &c) in goal.path.iter().enumerate() {
                let solutions = near_margin.solve(c, goal.tolerance);
                for (&(a, b), (solution, normal)) in pairs.iter().zip(solutions) {
                    let sides = (self.classes()[a], Some(self.classes()[b]));
                    problems[at].push(self.problem(&self.pair_rows(a, b), sides, solution));
                    // The number of pairs of the preceding classes, plus the pairs of the first class with preceding others.
                    let number = a * (2 * n_classes - a - 1) / 2 + (b - a - 1);
                    let to = normals[at].row_mut(number).into_slice();
                    to.expect("normals are stored one by one")
                        .copy_from_slice(&normal);
                }
            }
        }
        in_order(&mut problems);
        let with_normals = |(problems, normals)| Trained {
            problems,
            normals: Some(normals),
        };
        problems
            .into_iter()
            .zip(normals)
            .map(with_normals)
            .collect()
    }

    fn pairs_from_blocks(&self, goal: Goal, problems: &mut [Vec<BinaryProblem>]) {
        let classes = groups(self.ranges());
        let groups: Vec<Group<T>> = classes.iter().map(|own| Group::new(self, own)).collect();
        let (mut between, mut above, mut workspace) = (Vec::new(), Vec::new(), Workspace::new());
        for (at, own) in groups.iter().enumerate() {
            for (number, other) in groups.iter().enumerate().skip(at) {
                if number > at {
                    own.with(other, &mut between);
                }
                for (a, b) in pairs(classes[at].clone(), classes[number].clone()) {
                    let [first, second] = [a, b].map(|class| &self.ranges()[class]);
                    let below = if number > at {
                        own.part_with(other, &between, (second, first))
                    } else {
                        own.own_part(second, first)
                    };
                    above.resize(first.len() * second.len(), T::zero());
                    write_columns(&below, &mut above, second.len());
                    let across = [above.chunks_exact(second.len()).collect(), below];
                    let within = [own.own_part(first, first), other.own_part(second, second)];
                    let mut gram = part_of_blocks(&within, &across, &mut workspace);
                    self.solve_pair(&mut gram, (a, b), goal, problems);
                }
            }
        }
        in_order(problems);
    }

    fn pairs_from_rows(&self, goal: Goal, problems: &mut [Vec<BinaryProblem>]) {
        for (a, b) in self.all_pairs() {
            let points = self.points().select(&self.pair_rows(a, b));
            let mut gram = Cached::new(&points, self.kernel(), goal.memory);
            self.solve_pair(&mut gram, (a, b), goal, problems);
        }
    }

    fn solve_pair<G: Gram<T>>(
        &self,
        gram: &mut G,
        (a, b): (usize, usize),
        goal: Goal,
        problems: &mut [Vec<BinaryProblem>],
    ) {
        let n_first = self.ranges()[a].len();
        let mut labels = vec![1.0; n_first];
        labels.resize(gram.len(), -1.0);
        let rows = self.pair_rows(a, b);
        let limits = labels.iter().zip(&rows);
        let limits: Vec<f64> = limits
            .map(|(label, &row)| label * self.weights()[row])
            .collect();
        let sides = (self.classes()[a], Some(self.classes()[b]));
        self.solve(gram, (&labels, &limits, &rows), sides, goal, problems);
    }

    /// Solves one binary problem for each class, which separates the class from all others. Returns, for each C of the path, one problem per class.
    pub fn one_vs_rest(&self, goal: Goal) -> Vec<Trained<T>> {
        let mut problems = vec![Vec::new(); goal.path.len()];
        let storage = self.storage(Multiclass::OneVsRest);
        if let Stored::Whole(_) = storage.within::<T>(goal.memory) {
            let all = self.points().all();
            let mut gram = Dense::default();
            gram.of_whole(all.own_kernel(&self.kernel()).view());
            self.against_rest(&mut gram, goal, &mut problems);
        } else {
            let mut gram = Cached::new(self.points(), self.kernel(), goal.memory);
            self.against_rest(&mut gram, goal, &mut problems);
        }
        without_normals(problems)
    }

    fn against_rest<G: Gram<T>>(
        &self,
        gram: &mut G,
        goal: Goal,
        problems: &mut [Vec<BinaryProblem>],
    ) {
        let rows: Vec<usize> = (0..self.points().len()).collect();
        for (range, &class) in self.ranges().iter().zip(self.classes()) {
            let mut labels = vec![-1.0; rows.len()];
            labels[range.clone()].fill(1.0);
            let limits = labels.iter().zip(self.weights());
            let limits: Vec<f64> = limits.map(|(label, weight)| label * weight).collect();
            let sides = (class, None);
            self.solve(gram, (&labels, &limits, &rows), sides, goal, problems);
            // Restores the order of the training rows, which is common to all these problems.
            for problem in problems.iter_mut().filter_map(|path| path.last_mut()) {
                let mut coefficients = vec![0.0; rows.len()];
                for (&row, &beta) in problem.rows.iter().zip(&problem.solution.coefficients) {
                    coefficients[row] = beta;
                }
                problem.solution.coefficients = coefficients;
                problem.rows.clone_from(&rows);
            }
        }
    }

    /// Solves one binary problem on the given sorted rows, with their labels and limits, for each value of the penalty C.
    fn solve<G: Gram<T>>(
        &self,
        gram: &mut G,
        (labels, limits, rows): (&[f64], &[f64], &[usize]),
        sides: (usize, Option<usize>),
        goal: Goal,
        problems: &mut [Vec<BinaryProblem>],
    ) {
        let mut smo = Smo::new(gram, labels).with_limits(limits);
        for (&c, problems) in goal.path.iter().zip(problems) {
            let solution = smo.solve(c, goal.tolerance);
            problems.push(self.problem(rows, sides, solution));
        }
    }

    /// Creates a binary problem with its solution, and converts the solution's offset from centred rows to original rows.
    fn problem(
        &self,
        rows: &[usize],
        (positive, negative): (usize, Option<usize>),
        mut solution: DualSolution,
    ) -> BinaryProblem {
        solution.rho += self.moved(rows.iter().copied(), &solution.coefficients);
        BinaryProblem {
            positive,
            negative,
            rows: rows.iter().map(|&row| self.order()[row]).collect(),
            solution,
        }
    }
}

fn without_normals<T>(problems: Vec<Vec<BinaryProblem>>) -> Vec<Trained<T>> {
    let trained = |problems| Trained {
        problems,
        normals: None,
    };
    problems.into_iter().map(trained).collect()
}

/// Sorts the problems for each C in the order of their classes.
fn in_order(problems: &mut [Vec<BinaryProblem>]) {
    for problems in problems {
        problems.sort_by_key(|problem| (problem.positive, problem.negative));
    }
}
