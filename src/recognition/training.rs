//! Many binary problems from one set of rows: what they share is computed once.
//!
//! One-vs-one needs every block of kernel values between two classes exactly once, and every block within a class for all
//! its pairs: rows are sorted by class, blocks within classes are kept, and one panel (a few classes against all later
//! ones) is made at a time by a matrix product. So n rows of k classes take about n²/k values in memory, not n². One-vs-rest
//! shares the whole matrix. All C of a path are solved while a problem's Gram matrix is at hand, each from the last.

use std::ops::Range;

use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis, s};

use crate::recognition::dataset::Dataset;
use crate::recognition::kernel::KernelFunction;
use crate::recognition::points::Points;
use crate::recognition::scalar::Scalar;
use crate::recognition::smo::{Cached, Dense, Gram, Smo};
use crate::recognition::svm::BinaryProblem;

/// Rows of a panel, at least, while classes last: enough that a product's time goes into its multiplications.
const PANEL_ROWS: usize = 512;

/// Training rows sorted by class, about their centre.
pub(crate) struct Sorted<T> {
    points: Points<T>,
    /// The original number of each sorted row.
    order: Vec<usize>,
    /// The sorted rows of each class.
    ranges: Vec<Range<usize>>,
    classes: Vec<usize>,
    kernel: KernelFunction,
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
        let sorted = data.records.select(Axis(0), &order);
        let centre_products = match kernel {
            // Row by row: far from the origin, x·c − c·c would be two large numbers less each other.
            KernelFunction::Linear => {
                let product = |row: ArrayView1<f64>| (&row - &centre).dot(&centre);
                sorted.rows().into_iter().map(product).collect()
            }
            _ => Vec::new(),
        };
        Self {
            points: Points::new(sorted.view(), centre),
            order,
            ranges,
            classes: classes.to_vec(),
            kernel,
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
        if self.fits(goal.memory) {
            self.pairs_from_panels(goal, &mut problems);
        } else {
            self.pairs_from_rows(goal, &mut problems);
        }
        problems
    }

    /// Whether the blocks within classes, the largest panel and the largest pair fit.
    fn fits(&self, memory: usize) -> bool {
        let n_rows = self.points.len();
        let sizes = || self.ranges.iter().map(Range::len);
        let largest = sizes().max().unwrap_or(0);
        let within: usize = sizes().map(|n| n * n).sum();
        (within + (PANEL_ROWS + largest) * n_rows) * size_of::<T>() + Dense::<T>::bytes(2 * largest)
            <= memory
    }

    fn pairs_from_panels(&self, goal: Goal, problems: &mut [Vec<BinaryProblem>]) {
        let within: Vec<Array2<T>> = self
            .ranges
            .iter()
            .map(|range| {
                let own = self.points.range(range.clone());
                own.kernel(own, &self.kernel)
            })
            .collect();
        let mut gram = Dense::default();
        let mut next = 0;
        while next < self.ranges.len() {
            let group = self.group_from(next);
            next = group.end;
            let start = self.ranges[group.start].start;
            let own = self.points.range(start..self.ranges[group.end - 1].end);
            let later = self.points.range(start..self.points.len());
            let panel = own.kernel(later, &self.kernel);
            let within_panel = |range: &Range<usize>| range.start - start..range.end - start;
            for a in group {
                for b in a + 1..self.ranges.len() {
                    let rows = within_panel(&self.ranges[a]);
                    let columns = within_panel(&self.ranges[b]);
                    let across = panel.slice(s![rows, columns]);
                    gram.of_blocks(within[a].view(), across, within[b].view());
                    self.solve_pair(&mut gram, (a, b), goal, problems);
                }
            }
        }
    }

    /// The classes from this one on whose rows make one panel.
    fn group_from(&self, first: usize) -> Range<usize> {
        let start = self.ranges[first].start;
        let is_short = |range: &Range<usize>| range.end - start < PANEL_ROWS;
        let n_short = self.ranges[first..]
            .iter()
            .take_while(|range| is_short(range))
            .count();
        first..(first + n_short + 1).min(self.ranges.len())
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
        (positive, negative): (usize, Option<usize>),
        goal: Goal,
        problems: &mut [Vec<BinaryProblem>],
    ) {
        let mut smo = Smo::new(gram, is_positive);
        let original: Vec<usize> = rows.iter().map(|&row| self.order[row]).collect();
        for (&c, problems) in goal.path.iter().zip(problems) {
            let mut solution = smo.solve(c, goal.tolerance);
            if !self.centre_products.is_empty() {
                let pairs = solution.coefficients.iter().zip(rows);
                let moved: f64 = pairs
                    .map(|(beta, &row)| beta * self.centre_products[row])
                    .sum();
                solution.rho += moved;
            }
            problems.push(BinaryProblem {
                positive,
                negative,
                rows: original.clone(),
                solution,
            });
        }
    }
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
