//! Many binary problems from one set of rows: what they share is computed once.
//!
//! One-vs-one needs every block of kernel values between two classes exactly once, and every block within a class for all
//! its pairs: rows are sorted by class, blocks within classes are kept, and the block between two classes is written by a
//! matrix product to where the solver reads it. So n rows of k classes take about n²/k values in memory, not n².
//! One-vs-rest shares the whole matrix. All C of a path are solved while a problem's Gram matrix is at hand, each from the last.

use std::ops::Range;

use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis, Zip};

use crate::recognition::dataset::Dataset;
use crate::recognition::dual::DualSolution;
use crate::recognition::kernel::KernelFunction;
use crate::recognition::near_margin::NearMargin;
use crate::recognition::points::Points;
use crate::recognition::scalar::Scalar;
use crate::recognition::smo::{Cached, Dense, Gram, Smo, copy};
use crate::recognition::svm::BinaryProblem;

/// Features from which on one-vs-one linear SVMs are solved on the rows near their margins.
const SCREENING_FROM_FEATURES: usize = 128;
/// Rows a class, on average, below which there is little to leave out.
const SCREENING_FROM_ROWS: usize = 64;

/// Training rows sorted by class, about their centre.
pub(crate) struct Sorted<T> {
    points: Points<T>,
    /// The original number of each sorted row.
    order: Vec<usize>,
    /// Where each original row is.
    place: Vec<usize>,
    /// The sorted rows of each class.
    ranges: Vec<Range<usize>>,
    classes: Vec<usize>,
    kernel: KernelFunction,
    centre: Array1<f64>,
    /// `(x − c)·c` per sorted row, for ρ about the origin with a linear kernel; empty for the others.
    centre_products: Vec<f64>,
}

/// What to solve for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal<'a> {
    /// The penalties, in the order in which each starts from the last.
    pub path: &'a [f64],
    /// The largest violation of the optimality conditions.
    pub tolerance: f64,
    /// Most bytes of kernel values held at once.
    pub memory: usize,
}

impl<T: Scalar> Sorted<T> {
    /// Sorts rows by class; within a class they keep their order.
    pub fn new(
        data: &Dataset,
        classes: &[usize],
        kernel: KernelFunction,
        centre: ArrayView1<f64>,
    ) -> Self {
        Self::within_classes(data, classes, kernel, centre, |_| 0)
    }

    /// Sorts rows by class, and within a class by a key.
    pub fn within_classes(
        data: &Dataset,
        classes: &[usize],
        kernel: KernelFunction,
        centre: ArrayView1<f64>,
        key: impl Fn(usize) -> usize,
    ) -> Self {
        let labels = data.targets.view();
        let mut order: Vec<usize> = (0..labels.len()).collect();
        order.sort_by_key(|&row| (labels[row], key(row)));
        let start = |class: usize| order.partition_point(|&row| labels[row] < class);
        let ranges = classes
            .iter()
            .map(|&class| start(class)..start(class + 1))
            .collect();
        let mut place = vec![0; order.len()];
        for (at, &row) in order.iter().enumerate() {
            place[row] = at;
        }
        let rows = || order.iter().map(|&row| data.records.row(row));
        let centre_products = match kernel {
            // Row by row: far from the origin, x·c − c·c would be two large numbers less each other.
            KernelFunction::Linear => about(rows(), centre, |moved| moved.dot(&centre)).collect(),
            _ => Vec::new(),
        };
        Self {
            points: Points::of_rows(rows(), centre),
            order,
            place,
            ranges,
            classes: classes.to_vec(),
            kernel,
            centre: centre.to_owned(),
            centre_products,
        }
    }

    /// The rows, class by class.
    pub fn points(&self) -> &Points<T> {
        &self.points
    }

    /// The original number of each sorted row.
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// Where each original row is among the sorted ones.
    pub fn place(&self) -> &[usize] {
        &self.place
    }

    /// The kernel of all problems.
    pub fn kernel(&self) -> KernelFunction {
        self.kernel
    }

    /// What was subtracted from every row.
    pub fn centre(&self) -> ArrayView1<'_, f64> {
        self.centre.view()
    }

    /// ρ of a problem's decision function about the centre.
    pub fn rho_about_centre(&self, problem: &BinaryProblem) -> f64 {
        problem.solution.rho
            - self.moved(
                problem.rows.iter().map(|&row| self.place[row]),
                &problem.solution.coefficients,
            )
    }

    /// What the centre adds to ρ, for coefficients of these sorted rows; 0 for kernels other than the linear one.
    fn moved(&self, rows: impl Iterator<Item = usize>, coefficients: &[f64]) -> f64 {
        if self.centre_products.is_empty() {
            return 0.0;
        }
        rows.zip(coefficients)
            .map(|(row, beta)| beta * self.centre_products[row])
            .sum()
    }

    /// The classes, ascending.
    pub fn classes(&self) -> &[usize] {
        &self.classes
    }

    /// Each class with its sorted rows.
    pub fn classes_and_ranges(&self) -> impl Iterator<Item = (usize, Range<usize>)> + '_ {
        self.classes
            .iter()
            .copied()
            .zip(self.ranges.iter().cloned())
    }

    /// Solves every pair of classes: for each C of the path, the problems (0, 1), (0, 2), …, (1, 2), ….
    pub fn one_vs_one(&self, goal: Goal) -> Vec<Vec<BinaryProblem>> {
        let mut problems = vec![Vec::new(); goal.path.len()];
        if self.is_worth_screening(goal.memory) {
            self.pairs_near_margin(goal, &mut problems);
        } else if self.fits(goal.memory) {
            self.pairs_from_blocks(goal, &mut problems);
        } else {
            self.pairs_from_rows(goal, &mut problems);
        }
        problems
    }

    /// Whether the blocks within classes and the largest pair fit.
    fn fits(&self, memory: usize) -> bool {
        let sizes = || self.ranges.iter().map(Range::len);
        let largest = sizes().max().unwrap_or(0);
        let within: usize = sizes().map(|n| n * n).sum();
        within * size_of::<T>() + Dense::<T>::bytes(2 * largest) <= memory
    }

    /// Whether products take so long that hyperplanes should say which are needed.
    fn is_worth_screening(&self, memory: usize) -> bool {
        let most = || NearMargin::most_bytes(&self.points, &self.ranges);
        self.kernel == KernelFunction::Linear
            && self.centre.len() >= SCREENING_FROM_FEATURES
            && self.points.len() >= SCREENING_FROM_ROWS * self.ranges.len()
            && most() <= memory
    }

    fn pairs_near_margin(&self, goal: Goal, problems: &mut [Vec<BinaryProblem>]) {
        let mut pairs = NearMargin::new(&self.points, &self.ranges);
        for (&c, problems) in goal.path.iter().zip(problems) {
            let mut solutions = pairs.solve(c, goal.tolerance).into_iter();
            for a in 0..self.ranges.len() {
                for b in a + 1..self.ranges.len() {
                    let sides = (self.classes[a], Some(self.classes[b]));
                    let solution = solutions.next().expect("every pair is solved");
                    problems.push(self.problem(&self.pair_rows(a, b), sides, solution));
                }
            }
        }
    }

    fn pairs_from_blocks(&self, goal: Goal, problems: &mut [Vec<BinaryProblem>]) {
        let within: Vec<Array2<T>> = self
            .ranges
            .iter()
            .map(|range| {
                let own = self.points.range(range.clone());
                own.kernel(own, &self.kernel)
            })
            .collect();
        let mut gram = Dense::default();
        for a in 0..self.ranges.len() {
            for b in a + 1..self.ranges.len() {
                let [first, second] =
                    [a, b].map(|class| self.points.range(self.ranges[class].clone()));
                gram.of_blocks(
                    first.len(),
                    second.len(),
                    |i, row| copy(row, within[a].row(i)),
                    |i, row| copy(row, within[b].row(i)),
                    |across| first.kernel_into(second, &self.kernel, across),
                );
                self.solve_pair(&mut gram, (a, b), goal, problems);
            }
        }
    }

    fn pairs_from_rows(&self, goal: Goal, problems: &mut [Vec<BinaryProblem>]) {
        for a in 0..self.ranges.len() {
            for b in a + 1..self.ranges.len() {
                let points = self.points.select(&self.pair_rows(a, b));
                let mut gram = Cached::new(&points, self.kernel, goal.memory);
                self.solve_pair(&mut gram, (a, b), goal, problems);
            }
        }
    }

    /// Sorted numbers of the rows of two classes.
    fn pair_rows(&self, a: usize, b: usize) -> Vec<usize> {
        self.ranges[a]
            .clone()
            .chain(self.ranges[b].clone())
            .collect()
    }

    fn solve_pair<G: Gram<T>>(
        &self,
        gram: &mut G,
        (a, b): (usize, usize),
        goal: Goal,
        problems: &mut [Vec<BinaryProblem>],
    ) {
        let n_first = self.ranges[a].len();
        let is_positive: Vec<bool> = (0..gram.len()).map(|i| i < n_first).collect();
        let sides = (self.classes[a], Some(self.classes[b]));
        self.solve(
            gram,
            (&is_positive, &self.pair_rows(a, b)),
            sides,
            goal,
            problems,
        );
    }

    /// Solves each class against all others: for each C of the path, one problem a class.
    pub fn one_vs_rest(&self, goal: Goal) -> Vec<Vec<BinaryProblem>> {
        let mut problems = vec![Vec::new(); goal.path.len()];
        // Twice: as the product leaves it, and as the solver reads it.
        if 2 * Dense::<T>::bytes(self.points.len()) <= goal.memory {
            let all = self.points.all();
            let mut gram = Dense::default();
            gram.of_whole(all.kernel(all, &self.kernel).view());
            self.against_rest(&mut gram, goal, &mut problems);
        } else {
            let mut gram = Cached::new(&self.points, self.kernel, goal.memory);
            self.against_rest(&mut gram, goal, &mut problems);
        }
        problems
    }

    fn against_rest<G: Gram<T>>(
        &self,
        gram: &mut G,
        goal: Goal,
        problems: &mut [Vec<BinaryProblem>],
    ) {
        let rows: Vec<usize> = (0..self.points.len()).collect();
        for (range, &class) in self.ranges.iter().zip(&self.classes) {
            let is_positive: Vec<bool> = rows.iter().map(|row| range.contains(row)).collect();
            self.solve(gram, (&is_positive, &rows), (class, None), goal, problems);
            // Back into the order of the training rows, which all these problems share.
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

    /// One problem on these sorted rows, along the path.
    fn solve<G: Gram<T>>(
        &self,
        gram: &mut G,
        (is_positive, rows): (&[bool], &[usize]),
        sides: (usize, Option<usize>),
        goal: Goal,
        problems: &mut [Vec<BinaryProblem>],
    ) {
        let mut smo = Smo::new(gram, is_positive);
        for (&c, problems) in goal.path.iter().zip(problems) {
            let solution = smo.solve(c, goal.tolerance);
            problems.push(self.problem(rows, sides, solution));
        }
    }

    /// A problem on these sorted rows, from its solution about the centre.
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
            rows: rows.iter().map(|&row| self.order[row]).collect(),
            solution,
        }
    }
}

/// What a function gives for each row (m) less the centre (m).
pub(crate) fn about<'a, V>(
    rows: impl Iterator<Item = ArrayView1<'a, f64>>,
    centre: ArrayView1<f64>,
    value: impl Fn(&Array1<f64>) -> V,
) -> impl Iterator<Item = V> {
    let mut moved = Array1::zeros(centre.len());
    rows.map(move |row| {
        Zip::from(&mut moved)
            .and(row)
            .and(centre)
            .for_each(|to, x, c| *to = x - c);
        value(&moved)
    })
}

/// Where kernels are taken about: the mean of the rows where that changes nothing but rounding, else the origin.
pub(crate) fn centre(features: ArrayView2<f64>, kernel: &KernelFunction) -> Array1<f64> {
    match kernel {
        KernelFunction::Linear | KernelFunction::Rbf { .. } => {
            features.sum_axis(Axis(0)) / features.nrows() as f64
        }
        KernelFunction::Polynomial { .. } => Array1::zeros(features.ncols()),
    }
}
